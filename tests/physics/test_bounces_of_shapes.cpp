// How high boxes, capsules and discs bounce on boxes, segments and walls: exactly, wherever in a step they
// meet.
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include <carom/carom.hpp>

namespace test_bounces_of_shapes {

using namespace carom;

namespace {

constexpr double kGravity = 10;  // m/s²

struct Bounce {
    double height = 0;       // m, of the first bounce
    double unexplained = 0;  // J of each J that it had at the start
};

template <class W>
Bounce bounce(const Shape& shape, const Shape& floor, double drop, double restitution, double step) {
    const Material material{.friction = 0.5, .restitution = restitution};
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.effects.ledger = true;
    const double low = std::holds_alternative<Box>(floor) ? -0.5 : 0;
    scene.add({.type = BodyType::static_body, .shape = floor, .position = {0, low}, .material = material});
    const BodyId id =
        scene.add({.shape = shape, .position = {0, 0.5 + drop}, .mass = 1, .material = material});
    W world(scene, {.threads = 1});
    bool has_met = false;
    Bounce found;
    for (double time = 0; time < 3; time += step) {
        world.step(step);
        const BodyState state = world.state(id);
        const double up = std::fmax(state.velocity.y, 0);
        has_met = has_met || up > 0;
        if (has_met && up == 0) break;
        if (has_met) found.height = state.position.y - 0.5 + up * up / (2 * kGravity);
    }
    found.unexplained = std::fabs(world.ledger().energy_by_cause.unexplained) / (kGravity * drop);
    return found;
}

}  // namespace

// A third higher on average than it should be, at a restitution of .2, before impacts of shapes had a time
// within the substep.
TEST_CASE_TEMPLATE("shapes bounce as high as they should", W, World, World64) {
    for (const Shape& floor : {Shape{Box{60, 1}}, Shape{Segment{{-30, 0}, {30, 0}}}})
        for (const Shape& shape : {Shape{Box{1, 1}}, Shape{Capsule{1, 0.5}}, Shape{Disc{0.5}}})
            for (const double restitution : {0.2, 0.5, 0.8, 1.0})
                for (const double step : {1.0 / 30, 1.0 / 60, 1.0 / 120})
                    for (int i = 0; i < test::scaled(8, 3); ++i) {
                        const double drop = 0.6 + 0.531 * i;
                        const Bounce found = bounce<W>(shape, floor, drop, restitution, step);
                        INFO("restitution ", restitution, ", steps of ", step, " s, dropped by ", drop, " m");
                        CHECK(found.height ==
                              doctest::Approx(restitution * restitution * drop).epsilon(0.003));
                        CHECK(found.unexplained < 1e-4);
                    }
}

}  // namespace test_bounces_of_shapes

// What a motor moves within a step, from rest, strikes what is just above it.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <vector>

#include <carom/carom.hpp>

namespace test_flippers {

using namespace carom;

namespace {

constexpr double kRadius = 0.12;     // m, of the ball
constexpr double kThickness = 0.15;  // m, of the flipper
constexpr double kArm = 0.7;         // m, from the axis to where it strikes

/// The speed that a ball at rest gets [m/s], some way above a flipper or a plunger at rest that is driven up.
template <class W>
double speed_of_ball(bool slides, double speed, double gap, double step) {
    Scene scene;
    scene.gravity = {};
    const Material rough{.friction = 0.3};
    const BodyId flipper = scene.add({.shape = Box{slides ? 0.4 : 1, kThickness},
                                      .position = {slides ? kArm : 0.5, 0},
                                      .mass = 1,
                                      .material = rough});
    const BodyId ball = scene.add({.shape = Disc{kRadius},
                                   .position = {kArm, kThickness / 2 + kRadius + gap},
                                   .mass = 0.2,
                                   .material = rough});
    Joint joint{.b = flipper};
    if (slides)
        joint.kind = PrismaticJoint{.axis = {0, 1}, .lower = 0, .upper = 0.6};
    else
        joint.kind = RevoluteJoint{.anchor = Vec2{0, 0}, .lower = 0, .upper = 0.9};
    const JointId axis = scene.add(joint);
    W world(scene, {.threads = 1});
    world.step(step);
    world.set_motor(axis, slides ? speed * kArm : speed, 5000);
    for (int i = 0; i < 0.2 / step; ++i) world.step(step);
    return world.state(ball).velocity.y;
}

}  // namespace

// It passed through balls that were 3 to 20 mm above it: its speed was known a step too late.
TEST_CASE_TEMPLATE("a flipper at rest throws the ball above it", W, World, World64) {
    for (const bool slides : {false, true})
        for (const double speed : {20.0, 40.0})
            for (const double step : {1.0 / 30, 1.0 / 60, 1.0 / 120})
                for (const double gap : {0.0, 0.001, 0.003, 0.01, 0.02, 0.05}) {
                    INFO((slides ? "slider, " : "hinge, "), speed, " rad/s, steps of ", step, " s, ", gap,
                         " m above");
                    // A ball that is pushed goes as fast as what pushes it; one that is hit, with twice that
                    // at most. The flipper pushes it sideways, too.
                    const double of_flipper = speed * kArm;
                    const double got = speed_of_ball<W>(slides, speed, gap, step);
                    CHECK(got > 0.6 * of_flipper);
                    CHECK(got < 2 * of_flipper);
                }
}

TEST_CASE("a flipper strikes in a world that its state was restored in, too") {
    const auto scene_with = [](const JointKind& kind) {
        Scene scene;
        scene.gravity = {};
        const BodyId flipper = scene.add({.shape = Box{1, kThickness}, .position = {0.5, 0}, .mass = 1});
        scene.add({.shape = Disc{kRadius}, .position = {kArm, kThickness / 2 + kRadius + 0.01}, .mass = 0.2});
        scene.add(Joint{.b = flipper, .kind = kind});
        return scene;
    };
    const JointId joint = JointId::of(0);
    World world(scene_with(RevoluteJoint{.anchor = Vec2{0, 0}, .lower = 0, .upper = 0.9}));
    world.step(1.0 / 60);
    world.set_motor(joint, 20, 5000);
    // As many changes of its joints, none of which is a motor.
    World other(scene_with(DistanceJoint{.anchor_a = {0, 5}, .max = 6}));
    other.set_limits(joint, 0, 6);
    other.step(1.0 / 60);
    std::vector<std::byte> state(world.state_bytes());
    world.save_state(state);
    other.restore_state(state);
    for (int i = 0; i < 6; ++i) world.step(1.0 / 60), other.step(1.0 / 60);
    CHECK(world.state({1, 0}).velocity.y > 0.6 * 20 * kArm);
    CHECK(other.state_hash() == world.state_hash());
}

}  // namespace test_flippers

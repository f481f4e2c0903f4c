// The adapters to other engines make the scene that was asked for. Engines that are not installed are not
// tested.
#include "accuracy/cases.hpp"
#include "accuracy/engines.hpp"
#include "accuracy/solvers.hpp"

#include <doctest/doctest.h>
#include <carom/errors.hpp>

#include <algorithm>
#include <cmath>

namespace test_engines {

using namespace carom;
using namespace carom::accuracy;

namespace {

Body disc(double radius, double mass, Vec2 position, Vec2 velocity) {
    return {.shape = Disc{radius}, .position = position, .velocity = velocity, .mass = mass};
}

Stepper stepper_of(const Scene& scene, const bench::PeerEngine& engine) {
    return {scene, {.dt = 1.0 / 240, .substeps = 4, .iterations = 10, .engine = engine.family}, 10, true};
}

}  // namespace

TEST_SUITE("tools/engines") {
    TEST_CASE("each has the masses, spins and drag of the scene, and says where bodies are in its order") {
        for (const bench::PeerEngine& engine : engines()) {
            CAPTURE(engine.family);
            Scene scene;
            scene.drag.linear = 0.5;
            scene.add(disc(0.5, 1, {0, 0}, {2, 0}));
            scene.add(disc(0.3, 10, {1, 0.1}, {-1, 0}));
            scene.add(disc(0.5, 1, {9, 9}, {0, 1}));
            scene.bodies[2].angular_velocity = 3, scene.bodies[2].angle = 0.25;
            Stepper stepper = stepper_of(scene, engine);
            CHECK(stepper.kinetic_energy() == doctest::Approx(2 + 5 + 0.5 + 0.5 * 0.125 * 9).epsilon(1e-5));
            stepper.advance_to(0.5);
            const double left = std::exp(-0.25);
            const BodyState light = stepper.state(0), heavy = stepper.state(1), alone = stepper.state(2);
            CHECK(light.velocity.x < 0);  // they met
            CHECK(light.velocity.x + 10 * heavy.velocity.x == doctest::Approx(-8 * left).epsilon(5e-3));
            CHECK(alone.velocity.y == doctest::Approx(left).epsilon(5e-3));
            CHECK(alone.position.y == doctest::Approx(9 + 2 * (1 - left)).epsilon(5e-3));
            CHECK(std::fabs(alone.angle - 0.25) > 1);
            CHECK(stepper.simulation().profile().impacts == 1);
            CHECK(stepper.simulation().profile().wall_impacts == 0);
        }
    }

    TEST_CASE("walls, friction, a rotation that is fixed, and what the walls give") {
        for (const bench::PeerEngine& engine : engines()) {
            CAPTURE(engine.family);
            Scene scene;
            scene.gravity = {0, -10};
            scene.walls =
                Walls{.min = {-1e5, 0}, .max = {1e5, 10}, .left = false, .right = false, .top = false};
            scene.walls->material.friction = 0.5;
            for (const bool fixed : {false, true}) {
                scene.add(disc(0.5, 2, {fixed ? 5.0 : 0.0, 0.5}, {2, 0}));
                scene.bodies.back().material.friction = 0.5;
                scene.bodies.back().fixed_rotation = fixed;
            }
            Stepper stepper = stepper_of(scene, engine);
            stepper.advance_to(1);
            const BodyState rolls = stepper.state(0), stands = stepper.state(1);
            CHECK(rolls.velocity.x == doctest::Approx(2 * 2.0 / 3).epsilon(0.02));
            CHECK(rolls.angular_velocity == doctest::Approx(-rolls.velocity.x / 0.5).epsilon(0.02));
            CHECK(std::fabs(stands.velocity.x) < 1e-3);
            CHECK(stands.position.x - 5 == doctest::Approx(4 / (2 * 0.5 * 10)).epsilon(0.05));
            CHECK(stands.angular_velocity == 0);
            CHECK(stepper.simulation().profile().wall_impacts == 2);
            CHECK(stepper.simulation().ledger().wall_impulse == doctest::Approx(2 * 2 * 10).epsilon(0.02));
        }
    }

    TEST_CASE("what a wall gives a disc that bounces is the change of its momentum") {
        for (const bench::PeerEngine& engine : engines()) {
            CAPTURE(engine.family);
            for (const double restitution : {0.5, 1.0}) {
                CAPTURE(restitution);
                Scene scene;
                scene.walls = Walls{.min = {-1e5, 0}, .max = {1e5, 100}, .left = false, .right = false};
                scene.walls->material.restitution = restitution;
                scene.add(disc(0.5, 2, {0, 1.53}, {0, -3}));
                scene.bodies.back().material.restitution = restitution;
                Stepper stepper = stepper_of(scene, engine);
                stepper.advance_to(1);
                CHECK(stepper.state(0).velocity.y == doctest::Approx(3 * restitution).epsilon(0.02));
                const double impulse = stepper.simulation().ledger().wall_impulse;
                if (engine.family == "Box2D 3")
                    CHECK(std::isnan(impulse));  // it does not tell: tools/peers/box2d_3.cpp
                else
                    CHECK(impulse == doctest::Approx(2 * 3 * (1 + restitution)).epsilon(0.02));
            }
        }
    }

    TEST_CASE(
        "what an engine has other rules for or cannot make is left out with the reason, and nothing else") {
        const auto makes = [](const bench::PeerEngine& engine, const Case& each) {
            try {
                engine.make({.name = std::string(each.id), .scene = each.scene(0)}, {});
                return true;
            } catch (const Error&) {
                return false;
            }
        };
        for (const Case& each : all_cases()) {
            const std::vector<LeftOut> left_out = left_out_of(each);
            const std::vector<Setting> settings = settings_of(each, false);
            for (const bench::PeerEngine& engine : engines()) {
                const bool is_out = std::any_of(left_out.begin(), left_out.end(), [&](const LeftOut& out) {
                    return out.engine == engine.family && !out.why.empty();
                });
                const bool is_computed = std::any_of(settings.begin(), settings.end(), [&](const Setting& s) {
                    return s.engine == engine.family;
                });
                CAPTURE(each.id);
                CAPTURE(engine.family);
                CHECK(is_out != is_computed);
                const bool has_other_rules = each.id == "A21" && engine.family == "Chipmunk";
                CHECK(is_out == (has_other_rules || !makes(engine, each)));
            }
        }
    }

    TEST_CASE("an engine that this program was built without is refused by name") {
        Scene scene;
        scene.add(disc(0.5, 1, {}, {}));
        CHECK_THROWS_AS((Stepper(scene, {.dt = 0.1, .engine = "ODE"}, 1)), Error);
    }
}

}  // namespace test_engines

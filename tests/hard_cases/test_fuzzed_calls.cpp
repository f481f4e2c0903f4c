// What fuzzed scripts of calls have brought to light (tests/fuzz/fuzz_world_calls.cpp), each as the smallest
// script that shows it.
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace test_fuzzed_calls {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s

std::vector<std::string> effects_on(const World& world) {
    std::vector<std::string> names;
    for (const EffectReport& effect : world.plan().effects)
        if (effect.on) names.push_back(effect.name);
    return names;
}

/// Two discs that touch, one of them hinged to the world.
Scene hinged_pair() {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    const BodyId hinged = scene.add(disc(0.5, 1, {0, 0}));
    scene.add(disc(0.5, 1, {0.99, 0}));
    scene.add(Joint{.b = hinged, .kind = RevoluteJoint{.anchor = Vec2{0, 0.2}}});
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/fuzzed calls") {
    TEST_CASE(
        "rotation forced off by the scene and rolling resistance forced on by the options are refused") {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.effects.rotation = false;
        scene.add(disc(0.5, 1, {0, 0}));
        WorldOptions options;
        options.effects.rolling_resistance = true;
        CHECK_THROWS_WITH_AS(World(scene, options), doctest::Contains("the effect rotation forced off"),
                             Error);
    }

    TEST_CASE_TEMPLATE("a force beyond all numbers breaks no joint; its body is quarantined, its force zero",
                       Real, float, double) {
        Scene scene;
        const BodyId box = scene.add({.shape = Box{1, 0.5}});
        const JointId drawn = scene.add(
            Joint{.b = box,
                  .kind = TargetJoint{
                      .anchor = {0.4, 0.2}, .target = {1e8, 1e8}, .max_force = 1e308, .frequency = 1e6}});
        BasicWorld<Real> world(scene);
        world.step(kStep);
        CHECK(world.quarantined() == std::vector<BodyId>{box});
        CHECK(world.joint_force(drawn) == Vec2{});
        CHECK(world.joint_torque(drawn) == 0);
        world.step(kStep);
        CHECK(world.joint_force(drawn) == Vec2{});
    }

    TEST_CASE("a body that solver event refuses turns on nothing") {
        Scene scene;
        scene.accuracy.solver = Solver::event;
        scene.walls = Walls{.min = {-4, -4}, .max = {4, 4}};
        scene.add(disc(0.5, 1, {0, 0}, {1, 0}, 1));
        World world(scene);
        const std::vector<std::string> before = effects_on(world);
        const std::uint64_t hash = world.state_hash();
        Body rough = disc(0.5, 1, {0.2, 0}, {}, 0.5);  // it overlaps the first one
        rough.material.friction = 0.5, rough.angle = 1;
        CHECK_THROWS_AS(world.add(rough), Error);
        CHECK(effects_on(world) == before);
        CHECK(world.bodies().angle.empty());
        CHECK(world.state_hash() == hash);
        world.step(kStep);
        CHECK(world.state({0, 0}).position.x == doctest::Approx(kStep));
    }

    TEST_CASE("a motor, limits and a target beyond what a scene may have are refused") {
        Scene scene;
        const BodyId box = scene.add({.shape = Box{1, 0.5}});
        const JointId hinge = scene.add(Joint{.b = box, .kind = RevoluteJoint{}});
        const JointId rope = scene.add(Joint{.b = box, .kind = DistanceJoint{.length = 1}});
        const JointId drawn = scene.add(Joint{.b = box, .kind = TargetJoint{.max_force = 1}});
        World world(scene);
        CHECK_THROWS_WITH_AS(world.set_motor(hinge, 1.1e7, 1), doctest::Contains("expected -1e+07 to 1e+07"),
                             Error);
        CHECK_THROWS_AS(world.set_motor(hinge, 1, INFINITY), Error);
        CHECK_THROWS_AS(world.set_limits(hinge, 0, 1.1e8), Error);
        CHECK_THROWS_AS(world.set_limits(rope, -0.1, 1), Error);
        CHECK_THROWS_AS(world.set_target(drawn, {0, 1.1e8}), Error);
        CHECK_NOTHROW(world.set_motor(hinge, kLargestSpeed, 0));
        CHECK_NOTHROW(world.set_limits(rope, 0, kLargestPosition));
    }

    TEST_CASE_TEMPLATE("joints do not look at contacts of a body that is gone, nor does a restored world",
                       Real, float, double) {
        BasicWorld<Real> world(hinged_pair());
        world.step(kStep);
        world.remove({1, 0});  // nothing is left that could touch
        BasicWorld<Real> copy(world);
        for (int step = 0; step < 3; ++step) world.step(kStep), copy.step(kStep);
        CHECK(copy.state_hash() == world.state_hash());
        // What comes back touches again.
        for (BasicWorld<Real>* each : {&world, &copy}) {
            each->add(disc(0.5, 1, {0.99, 0}));
            each->step(kStep);
        }
        CHECK(copy.state_hash() == world.state_hash());
        CHECK(world.profile().contacts == 1);
    }

    TEST_CASE_TEMPLATE("a mechanism that is hit takes nothing back from contacts that it had before it flew",
                       Real, float, double) {
        // A chain whose last link, a box, was pushed by a plate that is gone: discs hit it in flight.
        double worst = 0;
        for (const double speed : {5.0, 20.0, 80.0}) {
            CAPTURE(speed);
            Scene scene;
            const BodyId plate =
                scene.add({.type = BodyType::static_body, .shape = Box{4, 1}, .position = {0, -0.5}});
            BodyId before = scene.add({.shape = Box{1, 1}, .position = {0, 0.5}});
            for (int i = 1; i < 6; ++i) {
                const BodyId link = scene.add(disc(0.4, 1, {1.0 * i, 0.5}));
                scene.add(Joint{.a = before, .b = link, .kind = RevoluteJoint{.anchor = Vec2{i - 0.5, 0.5}}});
                before = link;
            }
            for (int i = 0; i < 3; ++i) {
                Body hammer = disc(0.5, 5, {2.0 * i + 1, 2 + speed / 10});
                hammer.velocity = {0, -speed};
                scene.add(hammer);
            }
            BasicWorld<Real> world(scene, {.solver = Solver::soft});
            for (int i = 0; i < 2; ++i) world.step(kStep);
            world.remove(plate);
            BasicWorld<Real> copy(world);
            const Vec2 start = world.ledger().momentum;
            for (int i = 0; i < 120; ++i) {
                world.step(kStep), copy.step(kStep);
                const Vec2 now = world.ledger().momentum;
                worst = std::max(worst, std::hypot(now.x - start.x, now.y - start.y));
            }
            CHECK(copy.state_hash() == world.state_hash());
        }
        report("momentum of a chain that is hit in flight off by ", worst, " kg m/s");
        CHECK(worst < (sizeof(Real) == sizeof(float) ? 0.02 : 1e-9));
    }

    TEST_CASE_TEMPLATE("a moving edge that left its margin does not stand for one that was removed", Real,
                       float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.add(disc(0.5, 1, {0, 1}));
        std::vector<BodyId> edges;
        for (int i = 0; i < 3; ++i)
            edges.push_back(scene.add({.type = BodyType::kinematic_body,
                                       .shape = Segment{{-2, 0}, {2, 0}},
                                       .position = {0, -0.1 * i},
                                       .velocity = {1, 0}}));
        BasicWorld<Real> world(scene);
        world.step(kStep);
        for (const std::size_t gone : {2u, 1u}) {
            world.remove(edges[gone]);
            world.set_velocity(edges[0], {50, 0});
            world.step(kStep);
            CHECK(world.state(edges[0]).velocity == Vec2{50, 0});
        }
        CHECK(world.state({0, 0}).position.y == doctest::Approx(1));
    }

    TEST_CASE_TEMPLATE("shapes that cannot turn bounce", Real, float, double) {
        // Nothing turns in such a world, as in a game whose figures stand upright.
        const Shape shapes[] = {Box{1, 1}, Capsule{0.6, 0.3},
                                Polygon{.vertices = {{-0.5, 0}, {0.5, 0}, {0, 1}}},
                                Compound{.pieces = {{.shape = Box{1, 0.4}}, {.shape = Box{0.4, 1}}}}};
        double worst = 0;
        for (const Shape& shape : shapes)
            for (const bool on_box : {false, true}) {
                CAPTURE(shape.index());
                CAPTURE(on_box);
                Scene scene;
                scene.gravity = {0, -10};
                if (on_box)
                    scene.add({.type = BodyType::static_body,
                               .shape = Box{20, 1},
                               .position = {0, -0.5},
                               .material = {.restitution = 0.5}});
                else
                    scene.walls = Walls{.min = {-10, 0}, .max = {10, 20}, .material = {.restitution = 0.5}};
                const BodyId id = scene.add({.shape = shape,
                                             .position = {0, 4},
                                             .material = {.restitution = 0.5},
                                             .fixed_rotation = true});
                BasicWorld<Real> world(scene);
                double highest = 0;
                int steps = 0;
                for (; world.state(id).velocity.y <= 0; ++steps) {
                    REQUIRE(steps < 120);
                    world.step(kStep);
                }
                for (; world.state(id).velocity.y > 0; ++steps) {
                    REQUIRE(steps < 120);
                    world.step(kStep);
                    highest = std::max(highest, world.state(id).position.y);
                }
                // From where it lies at rest it rises to e^2 of the height that it fell from.
                for (int step = 0; step < 600; ++step) world.step(kStep);
                const double rest = world.state(id).position.y;
                CHECK(std::fabs(world.state(id).velocity.y) < 1e-3);
                worst = std::max(worst, std::fabs((highest - rest) / (0.25 * (4 - rest)) - 1));
            }
        report("shapes that cannot turn bounce to a height off by ", worst, " of it");
        CHECK(worst < 0.02);
    }

    TEST_CASE_TEMPLATE("what a joint brought that broke in a step is no excess of a passive world", Real,
                       float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.effects.ledger = true;
        const BodyId drawn = scene.add(disc(0.5, 1, {0, 0}));
        BasicWorld<Real> world(scene);
        world.step(kStep);
        const auto check = [&](const char* what) {
            CAPTURE(what);
            REQUIRE(world.joint_count() == 0);
            const double speed = std::hypot(world.state(drawn).velocity.x, world.state(drawn).velocity.y);
            CHECK(speed > 0.1);
            CHECK(world.ledger().energy_excess.passive == 0);
            world.set_velocity(drawn, {});
        };
        world.add(Joint{.b = drawn,
                        .kind = TargetJoint{.target = {10, 0}, .max_force = 1000, .frequency = 5},
                        .break_force = 1});
        world.step(kStep);
        check("target");
        const Vec2 at = world.state(drawn).position;
        world.add(Joint{.b = drawn,
                        .kind = DistanceJoint{.anchor_a = {at.x, at.y - 3}, .length = 1, .frequency = 5},
                        .break_force = 1});
        world.step(kStep);
        check("spring");
        world.step(kStep);
        CHECK(world.ledger().energy_excess.passive == 0);
    }

    TEST_CASE_TEMPLATE("a world whose joints are removed begins as what they have left", Real, float,
                       double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -10};
        scene.effects.ledger = true;
        const BodyId lifted = scene.add(disc(0.5, 1, {0, 0}));
        BasicWorld<Real> world(scene);
        const JointId rod = world.add(
            Joint{.b = lifted, .kind = DistanceJoint{.anchor_a = {0, 3}, .anchor_b = {}, .length = 1}});
        for (int step = 0; step < 10; ++step) world.step(kStep);
        REQUIRE(world.state(lifted).position.y > 1);
        const double gained = world.ledger().energy_excess.passive;  // a gap is worth no energy
        CHECK(gained > 10);
        world.remove(rod);
        // Builds with assertions check here that this is no excess of a world of discs alone.
        for (int step = 0; step < 3; ++step) world.step(kStep);
        CHECK(world.ledger().energy_excess.passive == gained);
    }

    TEST_CASE_TEMPLATE("what touches a sleeper follows it when bodies are added and removed", Real, float,
                       double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.effects.sleep = true;
        const BodyId asleep = scene.add(disc(0.5, 1, {0, 0}));
        scene.add(disc(0.5, 1, {10, 0}));
        BasicWorld<Real> world(scene);
        for (int step = 0; step < 200; ++step) world.step(kStep);
        REQUIRE(world.is_asleep(asleep));
        const BodyId beside = world.add(disc(0.5, 1, {1.05, 0}, {0, 2}));
        world.step(kStep);
        REQUIRE(world.profile().contacts == 1);
        REQUIRE(world.is_asleep(asleep));
        // The row of the sleeper was that behind the one that is awake.
        for (int more = 0; more < 3; ++more) {
            const BodyId gone = world.add(disc(0.5, 1, {5.0 + more, 5}));
            world.add(disc(0.5, 1, {5.0 + more, 10}));
            world.remove(gone);
            world.step(kStep);
        }
        CHECK(world.is_asleep(asleep));
        CHECK(world.state(beside).velocity == Vec2{0, 2});
        CHECK(world.state(asleep).position == Vec2{});
    }

    TEST_CASE_TEMPLATE("a world restored to a time without contacts has none of those it had since", Real,
                       float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -10};
        scene.effects.ledger = true;
        scene.add({.type = BodyType::kinematic_body, .shape = Segment{{-2, 0}, {2, 0}}, .velocity = {0, 1}});
        BasicWorld<Real> world(scene), other(scene);
        std::vector<std::byte> start(world.state_bytes());
        world.save_state(start);
        for (const double x : {-1.0, 0.2, 1.4}) world.add(disc(0.5, 1, {x, 0.49}));
        for (int step = 0; step < 10; ++step) world.step(kStep);
        REQUIRE(world.ledger().energy_by_cause.drive > 1);
        world.restore_state(start);
        for (int step = 0; step < 10; ++step) world.step(kStep), other.step(kStep);
        CHECK(world.ledger().energy_by_cause.drive == 0);
        CHECK(world.ledger().momentum_by_cause.immovable == Vec2{});
        CHECK(world.state_hash() == other.state_hash());
    }

    TEST_CASE_TEMPLATE("blows of a short step are none of a long one", Real, float, double) {
        // Discs that lie in each other and press themselves into a corner, without gravity; then a step is
        // late. What stopped them is no force that the long step would have to expect.
        double worst = 0;
        for (const double late : {0.05, 0.1, 0.288}) {
            for (int before = 1; before < 6; ++before) {
                CAPTURE(late);
                CAPTURE(before);
                Scene scene;
                scene.accuracy.solver = Solver::soft, scene.accuracy.substeps = 8;
                scene.walls = Walls{.min = {-4, -10}, .max = {4, 4}};
                for (int i = 0; i < 5; ++i) {
                    Body rough =
                        disc(i == 3 ? 0.424 : 0.344, 1.72, {-3.44, -3.44}, {-3.44, i == 3 ? 1.68 : -3.44});
                    rough.material.friction = 0.344;
                    scene.add(rough);
                }
                BasicWorld<Real> world(scene);
                for (int step = 0; step < before; ++step) world.step(kStep);
                const double energy = world.ledger().energy.total();
                world.step(late);
                worst = std::max(worst, world.ledger().energy.total() / energy - 1);
            }
        }
        report("a late step gave ", worst, " of the energy");
        CHECK(worst < 1e-3);
    }

    TEST_CASE_TEMPLATE("a disc that is stuck in a gap too narrow for it falls nowhere and gains nothing",
                       Real, float, double) {
        double worst = 0;
        for (const double dt : {kStep, 0.05, 0.208}) {
            CAPTURE(dt);
            Scene scene;
            scene.gravity = {0, -10};
            scene.effects.ledger = true;
            for (const double x : {1.6, 2.944})
                for (const double y : {-5.68, -4.576, -3.472})
                    scene.add({.type = BodyType::static_body,
                               .shape = Segment{{1.28, -0.08}, {-5.6, 5.92}},
                               .position = {x, y},
                               .angle = -0.72});
            scene.add(disc(0.6, 1, {2.16, -3.76}));
            BasicWorld<Real> world(scene);
            for (int step = 0; step < 60; ++step) {
                world.step(dt);
                worst = std::max(worst, world.ledger().energy_excess.passive);
            }
        }
        report("a disc that is stuck gains ", worst, " J");
        CHECK(worst < 0.04);  // a thousandth of its potential
    }

    TEST_CASE_TEMPLATE("what lay on a body that is gone falls, where nothing is left to meet", Real, float,
                       double) {
        Scene scene;
        scene.accuracy.solver = Solver::impulse;
        scene.gravity = {0, -10};
        scene.effects.ledger = true;
        const BodyId below =
            scene.add({.type = BodyType::static_body, .shape = Disc{0.5}, .position = {0, 0}});
        const BodyId middle = scene.add(disc(0.5, 1, {0, 1})), top = scene.add(disc(0.5, 1, {0, 2}));
        BasicWorld<Real> world(scene);
        for (int step = 0; step < 10; ++step) world.step(kStep);
        REQUIRE(world.profile().touching == 2);
        for (const BodyId gone : {middle, below}) world.remove(gone);
        const double from = world.state(top).velocity.y;
        const double lost = world.ledger().energy_by_cause.restitution;
        for (int step = 1; step <= 6; ++step) {
            world.step(kStep);
            CHECK(world.state(top).velocity.y == doctest::Approx(from - 10 * step * kStep).epsilon(1e-5));
        }
        CHECK(world.ledger().energy_by_cause.restitution == lost);
    }
}

}  // namespace test_fuzzed_calls

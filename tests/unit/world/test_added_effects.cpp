#include "support/scenes.hpp"

#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>

namespace test_added_effects {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// A smooth disc on a floor that is rough, bouncy and resists rolling, under solver `soft`.
Scene smooth_scene() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {-100, 0}, .max = {100, 100}};
    scene.walls->material.friction = 0.5;
    scene.accuracy.solver = Solver::soft;
    scene.add(disc(0.5, 1, {0, 0.5}, {2, 0}));
    return scene;
}

Body sliding_disc(const Material& material) {
    return {.shape = Disc{0.5}, .position = {3, 0.5}, .velocity = {6, 0}, .mass = 2, .material = material};
}

bool is_on(const Plan& plan, std::string_view name) {
    return std::any_of(plan.effects.begin(), plan.effects.end(),
                       [&](const EffectReport& report) { return report.name == name && report.on; });
}

/// Adds `body` to a world that has run without it, and to the scene of a second one; both go on alike.
template <class Real>
BodyState state_if_added(Scene scene, const Body& body, int steps) {
    BasicWorld<Real> world(scene), whole([&] {
        Scene both = scene;
        both.add(body);
        return both;
    }());
    const BodyId id = world.add(body);
    for (int i = 0; i < steps; ++i) world.step(kStep), whole.step(kStep);
    CHECK(world.state_hash() == whole.state_hash());
    return world.state(id);
}

}  // namespace

TEST_SUITE("world/added effects") {
    TEST_CASE_TEMPLATE("friction that comes with an added body acts: it ends up rolling", Real, float,
                       double) {
        const BodyState rolls = state_if_added<Real>(smooth_scene(), sliding_disc({.friction = 0.5}), 120);
        CHECK(rolls.velocity.x == doctest::Approx(4).epsilon(1e-3));  // two thirds
        CHECK(rolls.angular_velocity == doctest::Approx(-8).epsilon(1e-3));
    }

    TEST_CASE_TEMPLATE("so do restitution and rolling resistance", Real, float, double) {
        Body ball = sliding_disc(bouncy(0.5));
        ball.velocity = {0, -4};
        CHECK(state_if_added<Real>(smooth_scene(), ball, 1).velocity.y == doctest::Approx(2).epsilon(0.1));
        const Material slow{.friction = 0.5, .rolling_resistance = 0.1};
        const BodyState resisted = state_if_added<Real>(smooth_scene(), sliding_disc(slow), 120);
        CHECK(resisted.velocity.x < 3.5);
    }

    TEST_CASE_TEMPLATE("a disc that must not turn still does not when friction comes later", Real, float,
                       double) {
        Scene scene = smooth_scene();
        scene.bodies[0].fixed_rotation = true;
        BasicWorld<Real> world(scene);
        world.add({.shape = Disc{0.5}, .position = {0, 1.5}, .mass = 1, .material = {.friction = 1}});
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state({0, 0}).angular_velocity == 0);
    }

    TEST_CASE_TEMPLATE("a world that has run takes them up as well", Real, float, double) {
        BasicWorld<Real> world(smooth_scene());
        for (int i = 0; i < 30; ++i) world.step(kStep);
        CHECK_FALSE(is_on(world.plan(), "friction"));
        CHECK(world.bodies().angular_velocity.empty());
        const BodyId id =
            world.add(sliding_disc({.friction = 0.5, .restitution = 0.2, .rolling_resistance = 0.01}));
        for (const char* effect : {"friction", "rotation", "restitution", "rolling resistance"})
            CHECK(is_on(world.plan(), effect));
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.state(id).velocity.x < 4.01);
        CHECK(world.state(id).angular_velocity < -5);
        CHECK(world.state({0, 0}).velocity.x == doctest::Approx(2));  // it stays smooth
    }

    TEST_CASE("what is forced off refuses a body that needs it, and the world stays as it was") {
        Scene scene = smooth_scene();
        World world(scene, {.effects = {.friction = false}});
        const auto before = world.state_hash();
        CHECK_THROWS_AS(world.add(sliding_disc({.friction = 0.5})), Error);
        CHECK(world.body_count() == 1);
        CHECK(world.state_hash() == before);
        CHECK_FALSE(is_on(world.plan(), "friction"));
    }

    TEST_CASE_TEMPLATE("angular drag begins with the first body that turns", Real, float, double) {
        Scene scene = smooth_scene();
        scene.gravity = {}, scene.walls.reset();
        scene.drag.angular = 1;
        Body turning = disc(0.5, 1, {5, 0});
        turning.angular_velocity = 3;
        CHECK(state_if_added<Real>(scene, turning, 60).angular_velocity ==
              doctest::Approx(3 * std::exp(-1.0)).epsilon(1e-4));
    }
}

}  // namespace test_added_effects

#include <carom/errors.hpp>
#include <carom/pairwise.hpp>

#include "reference/decay.hpp"
#include "support/seed_scenes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>

namespace test_pairwise {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The message of the error a scene is refused with, empty if it is accepted.
std::string refusal(const PairwiseScene& scene, ErrorCode code) {
    try {
        const Pairwise world(scene);
    } catch (const Error& error) {
        CHECK(error.code() == code);
        return error.what();
    }
    return {};
}

bool contains(const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
}

PairwiseScene one_disc(const PairwiseBody& body) {
    PairwiseScene scene;
    scene.bodies = {body};
    return scene;
}

}  // namespace

TEST_SUITE("reference/pairwise") {
    TEST_CASE("a body with a bad mass, radius or state is refused with its index, value and limit") {
        PairwiseScene scene = seed_scene_s1();
        scene.bodies[3].radius = -0.4;
        const std::string message = refusal(scene, ErrorCode::out_of_range);
        CHECK(contains(message, "radius of body 3 is -0.4 m"));
        CHECK(contains(message, "expected a finite number > 0"));

        CHECK(contains(refusal(one_disc({.mass = 0}), ErrorCode::out_of_range), "mass of body 0 is 0 kg"));
        CHECK(contains(refusal(one_disc({.mass = kInfinity}), ErrorCode::not_finite), "mass of body 0"));
        CHECK(contains(refusal(one_disc({.radius = 0}), ErrorCode::out_of_range), "radius of body 0"));
        CHECK(contains(refusal(one_disc({.x = kNaN}), ErrorCode::not_finite), "x of body 0 is nan m"));
        CHECK(contains(refusal(one_disc({.y = kInfinity}), ErrorCode::not_finite), "y of body 0 is inf m"));
        CHECK(contains(refusal(one_disc({.vx = -kInfinity}), ErrorCode::not_finite), "vx of body 0"));
        CHECK(contains(refusal(one_disc({.vy = kNaN}), ErrorCode::not_finite), "vy of body 0"));
        CHECK(contains(refusal(one_disc({.angle = kNaN}), ErrorCode::not_finite), "angle of body 0"));
        CHECK(contains(refusal(one_disc({.omega = kNaN}), ErrorCode::not_finite), "omega of body 0"));
    }

    TEST_CASE("a setting out of range is refused by its name") {
        const auto refused = [](auto change, ErrorCode code, const char* part) {
            PairwiseScene scene = seed_scene_s1();
            change(scene);
            CAPTURE(part);
            CHECK(contains(refusal(scene, code), part));
        };
        constexpr ErrorCode kRange = ErrorCode::out_of_range, kFinite = ErrorCode::not_finite;
        refused([](auto& s) { s.gravity_x = kNaN; }, kFinite, "gravity x is nan");
        refused([](auto& s) { s.gravity_y = kInfinity; }, kFinite, "gravity y");
        refused([](auto& s) { s.linear_drag = -1; }, kRange, "linear_drag is -1 1/s");
        refused([](auto& s) { s.angular_drag = kNaN; }, kFinite, "angular_drag");
        refused([](auto& s) { s.keep_per_step = 1.01; }, kRange,
                "keep_per_step is 1.01; expected a finite number >= 0 and <= 1");
        refused([](auto& s) { s.restitution = -0.1; }, kRange, "restitution is -0.1");
        refused([](auto& s) { s.walls->restitution = kNaN; }, kFinite, "restitution of the walls");
        refused([](auto& s) { s.walls->spin_kept = 2; }, kRange, "spin_kept");
        refused([](auto& s) { s.walls->max_y = kNaN; }, kFinite, "max y of the walls");
        refused([](auto& s) { s.walls->max_x = -1; }, ErrorCode::inconsistent, "expected min < max");
    }

    TEST_CASE("a step length below zero or not finite is refused and changes nothing; zero changes nothing") {
        Pairwise world(seed_scene_s1());
        for (const double dt : {-0.016, kNaN, kInfinity}) CHECK_THROWS_AS(world.step(dt), Error);
        world.step(0);
        CHECK(world.counts().steps == 0);
        CHECK(world.time() == 0);
        CHECK(world.bodies()[0].vy == -0.5);
        CHECK(world.bodies()[0].x == 2);
    }

    TEST_CASE("an empty world steps") {
        Pairwise world(PairwiseScene{});
        world.step(0.016);
        CHECK(world.counts().steps == 1);
        CHECK(world.counts().pair_tests == 0);
        CHECK(world.total_energy() == 0);
        CHECK(world.centre_of_mass().x == 0);
    }

    TEST_CASE("a step is gravity, then damping, then positions") {
        PairwiseScene scene = one_disc({.x = 1, .vx = 2, .angle = 0.5, .omega = 3});
        scene.gravity_y = -10;
        scene.keep_per_step = 0.5;
        Pairwise world(scene);
        world.step(0.25);
        const PairwiseBody& body = world.bodies()[0];
        CHECK(body.vx == 1);
        CHECK(body.vy == -1.25);  // (0 - 10 * 0.25) * 0.5: the gravity of this step is damped too
        CHECK(body.x == 1.25);
        CHECK(body.y == -0.3125);
        CHECK(body.angle == 1.25);
        CHECK(body.omega == 3);
    }

    TEST_CASE("decay is exp(-x) to 1e-15, 1 at zero and 0 far out") {
        CHECK(decay(0) == 1);
        CHECK(decay(709) == 0);
        CHECK(decay(1e300) == 0);
        for (int i = 1; i < 70000; ++i) {
            const double exponent = i < 60000 ? i * 1e-4 : (i - 59999) * 0.0707;
            const double expected = std::exp(-exponent);
            if (std::abs(decay(exponent) - expected) > 1e-15 * expected) {
                CAPTURE(exponent);
                CHECK(decay(exponent) == expected);
            }
        }
    }

    TEST_CASE("angular drag slows the spin alone") {
        PairwiseScene scene = one_disc({.vx = 1, .omega = 2});
        scene.angular_drag = 0.5;
        Pairwise world(scene);
        for (int step = 0; step < 10; ++step) world.step(0.1);
        CHECK(world.bodies()[0].omega == doctest::Approx(2 * std::exp(-0.5)).epsilon(1e-14));
        CHECK(world.bodies()[0].vx == 1);
    }

    TEST_CASE("a wall puts a body back, reverses it with restitution and keeps 0.9 of its spin") {
        PairwiseScene scene = one_disc({.x = 0.4, .y = 4, .vx = -2, .vy = 1, .omega = 10});
        scene.walls = PairwiseWalls{.max_x = 10, .max_y = 8, .restitution = 0.5};
        Pairwise world(scene);
        world.step(0.25);
        const PairwiseBody& body = world.bodies()[0];
        CHECK(body.x == 0.75);  // back to 0.5, then 1 m/s for 0.25 s
        CHECK(body.vx == 1);
        CHECK(body.vy == 1);
        CHECK(body.omega == 9);
        CHECK(world.counts().wall_contacts == 1);
        CHECK(world.counts().wall_impulse == 3);
    }

    TEST_CASE("each side of the walls can be left open") {
        const auto leaves = [](double vx, double vy, auto open) {
            PairwiseScene scene = one_disc({.x = 1, .y = 1, .vx = vx, .vy = vy});
            scene.walls = PairwiseWalls{.max_x = 2, .max_y = 2, .restitution = 1};
            open(*scene.walls);
            Pairwise world(scene);
            for (int step = 0; step < 10; ++step) world.step(0.5);
            return world.counts().wall_contacts == 0;
        };
        CHECK(leaves(-1, 0, [](PairwiseWalls& w) { w.left = false; }));
        CHECK(leaves(1, 0, [](PairwiseWalls& w) { w.right = false; }));
        CHECK(leaves(0, -1, [](PairwiseWalls& w) { w.bottom = false; }));
        CHECK(leaves(0, 1, [](PairwiseWalls& w) { w.top = false; }));
        CHECK_FALSE(leaves(1, 1, [](PairwiseWalls&) {}));
    }

    TEST_CASE("energies and momenta are those of solid discs") {
        PairwiseScene scene;
        scene.bodies = {{.x = 3, .y = 2, .vx = 1, .vy = -2, .mass = 2, .radius = 0.5, .omega = 4},
                        {.x = -1, .y = 0.5, .vx = -1, .vy = 0, .mass = 4, .radius = 1, .omega = -1}};
        scene.gravity_y = -10;
        const Pairwise world(scene);
        CHECK(world.rotational_energy() == 0.5 * 0.25 * 16 + 0.5 * 2 * 1);
        CHECK(world.kinetic_energy() == 5 + 2 + 2 + 1);
        CHECK(world.potential_energy() == 40 + 20);
        CHECK(world.total_energy() == 70);
        CHECK(world.momentum().x == -2);
        CHECK(world.momentum().y == -4);
        CHECK(world.angular_momentum() == 2 * (3 * -2 - 2 * 1) + 0.25 * 4 + 4 * (0 + 0.5) - 2);
        CHECK(world.centre_of_mass().x == doctest::Approx(2.0 / 6));
        CHECK(world.centre_of_mass().y == 1);
    }
}

}  // namespace test_pairwise

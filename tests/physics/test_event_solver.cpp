// Solver `event` through World and World64: A16, A17, A18, A19 and A21 of docs/exact-cases.md to round-off,
// reversal of time. A13 and A14 are in test_rough_impacts.cpp.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace test_event_solver {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

Scene exact(Scene scene) {
    scene.accuracy.solver = Solver::event;
    return scene;
}

}  // namespace

TEST_SUITE("physics/event solver") {
    TEST_CASE("A16: masses 1 and 100^k collide floor(10^k pi) times, k up to 4") {
        const std::array<std::int64_t, 5> expected{3, 31, 314, 3141, 31415};
        double ratio = 1;
        for (const std::int64_t collisions : expected) {
            for (const double dt : {kStep, 5.0}) {
                CAPTURE(ratio);
                World64 world(galperin_billiard(ratio, Solver::event));
                for (int i = static_cast<int>(std::lround(60 / dt)); i > 0; --i) world.step(dt);
                CHECK(world.profile().impacts == collisions);
                const double heavy = world.state({1, 0}).velocity.x, light = world.state({0, 0}).velocity.x;
                CHECK(std::abs((light * light + ratio * heavy * heavy) / ratio - 1) < 1e-10);
                CHECK(light <= heavy);
            }
            ratio *= 100;
        }
    }

    TEST_CASE_TEMPLATE("A17, A18: cradle and cannon", Real, float, double) {
        constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
        for (const int moving : {1, 2, 4}) {
            Trial<Real> trial(cradle(moving, 0.001, Solver::event));
            trial.run(90, kStep);
            for (int i = 0; i < 5; ++i)
                CHECK(std::abs(trial.state(static_cast<std::uint32_t>(i)).velocity.x -
                               (i >= 5 - moving ? 2.0 : 0.0)) <= kTolerance);
            CHECK(trial.world.profile().impacts == moving * (5 - moving));
            trial.check();
        }
        constexpr double kGravity = 9.81, kGap = 0.01;
        for (const double light : {0.01, 0.25}) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.walls = floor_at(0, 1);
            scene.add(disc(0.5, 1, {0, 1.5}, {}, 1));
            scene.add(disc(0.2, light, {0, 2 + kGap + 0.2}, {}, 1));
            Trial<Real> trial(exact(scene));
            trial.run(30, kStep);
            const double v = std::sqrt(2 * kGravity), wait = kGap / (2 * v);
            const double m = static_cast<double>(static_cast<Real>(light));
            const double up = v - kGravity * wait, down = -v - kGravity * wait;
            const double high = ((m - 1) * down + 2 * up) / (1 + m) - kGravity * (0.5 - v / kGravity - wait);
            CHECK(std::abs(trial.state(1).velocity.y - high) <= 10 * kTolerance);
            trial.check(2 * kGravity);
        }
    }

    TEST_CASE("A19: energy within 1e-12 over a million collisions, momentum without walls within 1e-14") {
        const std::int64_t count = 1000, collisions = scaled(1000000, 50000);
        World64 world(exact(gas_scene({.count = count})), {.threads = 1});
        const double start = world.ledger().energy.total();
        while (world.profile().impacts < collisions) world.step(1);
        const double change = world.ledger().energy.total() / start - 1;
        report("relative change of energy ", change, " after ", world.profile().impacts, " collisions");
        CHECK(std::abs(change) < 1e-12);
        CHECK(world.overlaps().max < 1e-12);

        Scene free = gas_scene({.count = 500, .packing_fraction = 0.5});
        free.walls.reset();
        World64 drifting(exact(free), {.threads = 1});
        const Ledger before = drifting.ledger();
        for (int i = 0; i < 120; ++i) drifting.step(kStep);
        const Ledger after = drifting.ledger();
        REQUIRE(drifting.profile().impacts > 1000);
        const double scale = dynamic_mass(free) * 3;
        CHECK(std::abs(after.momentum.x - before.momentum.x) < 1e-14 * scale);
        CHECK(std::abs(after.angular_momentum - before.angular_momentum) < 1e-14 * scale * 20);
    }

    TEST_CASE("friction passes energy of a gas into rotation and takes some; without it nothing turns") {
        Scene scene = gas_scene({.count = 400});
        World64 smooth(exact(scene), {.threads = 1, .effects = {.rotation = true}});
        for (int i = 0; i < 60; ++i) smooth.step(0.1);
        CHECK(smooth.ledger().energy.rotational == 0);
        for (Body& body : scene.bodies) body.material.friction = 0.5;
        World64 rough(exact(scene), {.threads = 1, .effects = {.ledger = true}});
        double energy = rough.ledger().energy.total();
        for (int i = 0; i < 60; ++i) {
            rough.step(0.1);
            const Ledger now = rough.ledger();
            REQUIRE(now.energy.total() < energy);  // friction takes some, always
            energy = now.energy.total();
            REQUIRE(std::abs(now.energy_by_cause.unexplained) < 1e-11 * now.initial.total());
        }
        CHECK(rough.ledger().energy.rotational > 0.05 * energy);
    }

    TEST_CASE("A21: a granular gas cools as exp(-(1 - e^2) tau / 2) to 3 % up to tau = 40") {
        constexpr double e = 0.95;
        const std::int64_t count = 2000;
        Scene scene = gas_scene({.count = count, .packing_fraction = 0.2, .restitution = e});
        scene.walls->material.restitution = 1;
        World64 world(exact(scene), {.threads = 1});
        const double start = world.ledger().energy.kinetic;
        double tau = 0;
        while (tau < scaled(40.0, 10.0)) {
            world.step(0.25);
            const Profile profile = world.profile();
            tau =
                2 * static_cast<double>(profile.impacts - profile.wall_impacts) / static_cast<double>(count);
            const double exact_energy = start * std::exp(-(1 - e * e) * tau / 2);
            CAPTURE(tau);
            REQUIRE(world.ledger().energy.kinetic == doctest::Approx(exact_energy).epsilon(0.03));
        }
        report("energy left ", world.ledger().energy.kinetic / start, " at tau ", tau);
    }

    TEST_CASE("with all velocities reversed a gas returns to where it was after 3 collisions a disc") {
        const std::int64_t count = 1000;
        const Scene scene = exact(gas_scene({.count = count}));
        World64 world(scene, {.threads = 1});
        int steps = 0;
        for (; world.profile().impacts < 3 * count / 2 + count; ++steps)
            world.step(kStep);  // pairs: two discs each
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec2 v = world.state({i, 0}).velocity;
            world.set_velocity({i, 0}, {-v.x, -v.y});
        }
        for (int i = 0; i < steps; ++i) world.step(kStep);
        double largest = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec2 x = world.state({i, 0}).position;
            largest = std::max(
                largest, std::hypot(x.x - scene.bodies[i].position.x, x.y - scene.bodies[i].position.y));
        }
        report("farthest from the start ", largest, " m");
        CHECK(largest < 1e-6 * 0.5);
    }

    TEST_CASE_TEMPLATE("every effect on and zero gives the same bits", Real, float, double) {
        Scene scene = gas_scene({.count = 200, .packing_fraction = 0.5, .restitution = 0.9});
        scene.gravity = {0.5, -2};
        Trial<Real> trial(exact(scene));
        trial.run(120, kStep);
        CHECK(trial.world.profile().impacts > 500);
        trial.check();
    }
}

}  // namespace test_event_solver

// B10 and B35 of docs/hard-cases.md: no step, tiny steps, one huge step, steps of changing length.
#include "math/random.hpp"
#include "support/report.hpp"
#include "support/rms_speed.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5;

/// Ten discs between walls, `slack` wider than they are and leaning left and right by as much.
Scene stack_between_walls(double restitution, double slack) {
    Scene scene;
    scene.accuracy.solver = restitution < 0.5 ? Solver::soft : Solver::impulse;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {2 * kRadius + slack, 100}, .material = bouncy(restitution)};
    double y = kRadius;
    for (int i = 0; i < 10; ++i) {
        const double x = kRadius + (i % 2 == 0 ? 0 : slack);
        scene.add(disc(kRadius, 1, {x, y}, {}, restitution));
        y += std::sqrt(4 * kRadius * kRadius - slack * slack);
    }
    return scene;
}

/// The discs are where they were put, but for the slop of ten contacts on top of each other, at rest, in
/// their order.
template <class Real>
void check_standing(const Trial<Real>& trial, const Scene& scene, double still = 1e-3) {
    double shift = 0, speed = 0, below = 0;
    for (std::uint32_t i = 0; i < 10; ++i) {
        const BodyState state = trial.state(i);
        const Vec2 from = scene.bodies[i].position;
        shift = std::max(shift, std::hypot(state.position.x - from.x, state.position.y - from.y));
        speed = std::max(speed, std::hypot(state.velocity.x, state.velocity.y));
        CHECK(state.position.y > below);
        below = state.position.y;
    }
    report("shift ", shift, " m, speed ", speed, " m/s");
    CHECK(shift < 10 * 0.005 * kRadius);
    CHECK(speed < still);
    CHECK(trial.world.overlaps().max < 0.01);
}

template <class Real>
void check_survival(const std::vector<double>& steps, double still = 1e-3) {
    for (const double restitution : {0.0, 0.5, 1.0})
        for (const double slack : {0.0, 0.2}) {
            CAPTURE(restitution);
            CAPTURE(slack);
            const Scene scene = stack_between_walls(restitution, slack);
            Trial<Real> trial(scene);
            const double start = trial.world.ledger().energy.total();
            for (const double dt : steps) {
                trial.step(dt);
                CHECK(trial.world.ledger().energy.total() < (1 + 1e-3) * start);
            }
            check_standing(trial, scene, restitution == 0 ? still : 1e-3);
            trial.check(start);
        }
}

/// Rough discs in a box open at the top, let go; `settled` is 20 s later.
Scene rough_pile() {
    constexpr int kDiscs = 400, kColumns = 15;
    const Material rough{.friction = 0.5};
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 400}, .top = false, .material = rough};
    Random random(1);
    for (int i = 0; i < kDiscs; ++i)
        scene.add({.shape = Disc{random.uniform(0.4, 0.6)},
                   .position = {0.65 + 1.25 * (i % kColumns) + random.uniform(0, 0.04),
                                0.7 + 1.25 * (i / kColumns)},
                   .material = rough});
    return scene;
}

template <class Real>
BasicWorld<Real> settled(const Scene& scene) {
    BasicWorld<Real> world(scene, {.threads = 1});
    for (int i = 0; i < 1200; ++i) world.step(1.0 / 60);
    return world;
}

constexpr double kCalm = 2e-3;  // m/s, root mean square in a pile at rest

}  // namespace

TEST_SUITE("hard cases/step lengths") {
    TEST_CASE_TEMPLATE("B35: one step of 0.1 to 30 times the usual length leaves a pile at rest", Real, float,
                       double) {
        const BasicWorld<Real> start = settled<Real>(rough_pile());
        REQUIRE(rms_speed(start) < kCalm);
        for (const double times : {0.1, 0.5, 2.1, 5.0, 30.0}) {
            CAPTURE(times);
            BasicWorld<Real> world(start);
            double most = 0;
            for (int i = 0; i < 60; ++i) {
                world.step((i == 0 ? times : 1) / 60);
                most = std::max(most, rms_speed(world));
            }
            report("one step of ", times, " times the usual: rms ", most, " m/s");
            CHECK(most < kCalm);
        }
    }

    TEST_CASE_TEMPLATE("B35: a pile at rest stays so under random steps of 1 to 50 ms", Real, float, double) {
        const BasicWorld<Real> start = settled<Real>(rough_pile());
        for (const double shortest : {1.0 / 240, 1e-3}) {
            const double longest = shortest > 2e-3 ? 1.0 / 30 : 0.05;
            BasicWorld<Real> world(start);
            Random random(5);
            double most = 0;
            for (int i = 0; i < 600; ++i) {
                world.step(random.uniform(shortest, longest));
                most = std::max(most, rms_speed(world));
            }
            report("steps of ", shortest, " to ", longest, " s: rms ", most, " m/s");
            CHECK(most < kCalm);
        }
    }

    TEST_CASE("B35: a pile falls asleep under random steps of 1 to 50 ms") {
        Scene scene = rough_pile();
        scene.effects.sleep = true;
        World world(scene, {.threads = 1});
        Random random(5);
        for (int i = 0; i < 2400 && world.profile().asleep < 400; ++i) world.step(random.uniform(1e-3, 0.05));
        CHECK(world.profile().asleep == 400);
    }

    TEST_CASE_TEMPLATE("a step of length zero changes no bit of any body, nor the time", Real, float,
                       double) {
        Scene scene = gas_scene({.count = 50, .smallest_radius = 0.1, .largest_radius = 0.8});
        scene.gravity = {0, -10};
        SUBCASE("solver impulse") {
            scene.accuracy.solver = Solver::impulse;
        }
        SUBCASE("solver soft") {
            scene.accuracy.solver = Solver::soft;
            for (Body& body : scene.bodies) body.material.restitution = 0.5;
        }
        scene.drag = {0.5, 0.5};
        scene.bodies[3].angular_velocity = 2;
        Trial<Real> trial(scene);
        for (int i = 0; i < 5; ++i) {
            const std::uint64_t before = trial.world.state_hash();
            const double time = trial.world.time();
            trial.step(0);
            CHECK(trial.world.state_hash() == before);
            CHECK(trial.world.time() == time);
            trial.step(1.0 / 60);
            CHECK(trial.world.state_hash() != before);
        }
        trial.check();
    }

    TEST_CASE_TEMPLATE("a stack of ten survives steps of a nanosecond", Real, float, double) {
        check_survival<Real>(std::vector<double>(1000, 1e-9));
    }

    TEST_CASE_TEMPLATE("a stack of ten survives a step of half a second", Real, float, double) {
        std::vector<double> steps(600, 1.0 / 60);
        steps[100] = 0.5;
        check_survival<Real>(steps);
        // As the very first step, when no contact carries anything yet: the stack gives way, and comes back.
        std::vector<double> cold(600, 1.0 / 60);
        cold[0] = 0.5;
        check_survival<Real>(cold);
    }

    TEST_CASE_TEMPLATE("a stack of ten survives steps that alternate between 1/30 and 1/240 s", Real, float,
                       double) {
        std::vector<double> steps;
        for (int i = 0; i < 600; ++i) steps.push_back(i % 2 == 0 ? 1.0 / 30 : 1.0 / 240);
        check_survival<Real>(steps, 0.3);
    }

    TEST_CASE_TEMPLATE("a stack dropped into a shaft comes to rest whole", Real, float, double) {
        for (const auto& pattern : {std::vector{1.0 / 60}, std::vector{1.0 / 30, 1.0 / 240}}) {
            Scene scene = stack_between_walls(0.3, 0.2);
            for (std::size_t i = 0; i < scene.bodies.size(); ++i)
                scene.bodies[i].position.y += 0.05 * static_cast<double>(i + 1);
            Trial<Real> trial(scene);
            const double start = trial.world.ledger().energy.total();
            for (int i = 0; trial.world.time() < 20; ++i) {
                trial.step(pattern[static_cast<std::size_t>(i) % pattern.size()]);
                CHECK(trial.world.ledger().energy.total() < (1 + 1e-3) * start);
            }
            check_standing(trial, stack_between_walls(0.3, 0.2), pattern.size() == 1 ? 1e-3 : 0.3);
            trial.check(start);
        }
    }
}

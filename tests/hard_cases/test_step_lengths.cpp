// B10 of docs/hard-cases.md: no step, tiny steps, one huge step, steps of changing length.
#include "support/report.hpp"
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

}  // namespace

TEST_SUITE("hard cases/step lengths") {
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
        // Solver `soft`, which takes the scenes without restitution, finds its impulses anew whenever
        // substeps become eight times longer or shorter: the stack stands, but trembles.
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

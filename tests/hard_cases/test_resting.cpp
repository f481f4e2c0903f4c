// B17 of docs/hard-cases.md and its surroundings: discs at rest under gravity stay at rest, whatever their
// restitution.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace test_resting {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kGravity = 10, kRadius = 0.5;

/// A box as wide as `columns` discs, open at the top.
Scene box_for(int columns, double restitution) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{
        .min = {0, 0}, .max = {2 * kRadius * columns, 1e3}, .top = false, .material = bouncy(restitution)};
    return scene;
}

Scene column(int discs, double restitution) {
    Scene scene = box_for(1, restitution);
    for (int i = 0; i < discs; ++i)
        scene.add(disc(kRadius, 1 + 0.1 * i, {kRadius, kRadius * (2 * i + 1)}, {}, restitution));
    return scene;
}

/// Rows of n, n - 1, ... 1 discs, each in the gaps of the one below.
Scene triangle(int base, double restitution) {
    Scene scene = box_for(base, restitution);
    const double rise = kRadius * std::sqrt(3.0);
    for (int row = 0; row < base; ++row)
        for (int i = 0; i < base - row; ++i)
            scene.add(disc(kRadius, 1, {kRadius * (2 * i + 1 + row), kRadius + rise * row}, {}, restitution));
    return scene;
}

/// A square block, every disc right above another.
Scene block(int side, double restitution) {
    Scene scene = box_for(side, restitution);
    for (int row = 0; row < side; ++row)
        for (int i = 0; i < side; ++i)
            scene.add(disc(kRadius, 1, {kRadius * (2 * i + 1), kRadius * (2 * row + 1)}, {}, restitution));
    return scene;
}

struct Extremes {
    double energy_change = 0;  // relative, largest of all steps
    double speed = 0;          // m/s
    double shift = 0;          // m, from the start
};

template <class Real>
Extremes watch(const Scene& scene, int steps) {
    Trial<Real> trial(scene);
    Extremes extremes;
    const double start = trial.world.ledger().energy.total();
    for (int i = 0; i < steps; ++i) {
        trial.step(kStep);
        const double change = trial.world.ledger().energy.total() / start - 1;
        extremes.energy_change = std::fmax(extremes.energy_change, std::abs(change));
    }
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyState s = trial.state(static_cast<std::uint32_t>(i));
        const Vec2 from = scene.bodies[i].position;
        extremes.speed = std::fmax(extremes.speed, std::hypot(s.velocity.x, s.velocity.y));
        extremes.shift = std::fmax(extremes.shift, std::hypot(s.position.x - from.x, s.position.y - from.y));
    }
    trial.check(start);
    return extremes;
}

}  // namespace

TEST_SUITE("hard cases/resting") {
    TEST_CASE_TEMPLATE("elastic discs that rest on each other keep their energy to 1e-3 for 60 s", Real,
                       float, double) {
        const int kSteps = scaled(3600, 600);
        std::vector<Scene> scenes;
        for (const double restitution : {1.0, 0.5, 0.0})
            for (Scene scene : {column(10, restitution), triangle(5, restitution), block(6, restitution)})
                scenes.push_back(scene);
        for (std::size_t i = 0; i < scenes.size(); ++i) {
            CAPTURE(i);
            const Extremes extremes = watch<Real>(scenes[i], kSteps);
            report("scene ", i, ": energy within ", extremes.energy_change, ", speed ", extremes.speed,
                   " m/s, shift ", extremes.shift, " m");
            // Without restitution the solver is `soft`: its contacts take some steps to carry the weight.
            const bool is_soft = scenes[i].bodies[0].material.restitution == 0;
            CHECK(extremes.energy_change < (is_soft ? 2e-3 : 1e-3));
            CHECK(extremes.speed < 1e-3);
            CHECK(extremes.shift < 0.01 * kRadius);
        }
    }

    TEST_CASE_TEMPLATE("a ball that rises ever so slowly from the floor does not hover", Real, float,
                       double) {
        for (const double speed : {1e-7, 1e-5, 3e-5, 1e-3, 3e-3})  // of it, gravity takes 0.17 m/s in a step
            for (const double restitution : {0.0, 0.5, 0.8}) {
                CAPTURE(speed);
                CAPTURE(restitution);
                Scene scene = box_for(4, 0);
                constexpr double kAbove = 1e-4 * kRadius;
                scene.add(disc(kRadius, 1, {2, kRadius + kAbove}, {0, speed}, restitution));
                Trial<Real> trial(scene);
                const double start = trial.world.ledger().energy.total();
                for (int i = 0; i < 600; ++i) {
                    trial.step(kStep);
                    CHECK(trial.world.ledger().energy.total() < (1 + 1e-6) * start);
                }
                CHECK(std::abs(trial.state(0).velocity.y) < 1e-12);
                CHECK(trial.state(0).position.y < kRadius + 2 * kAbove);
                trial.check(start);
            }
    }
}

}  // namespace test_resting

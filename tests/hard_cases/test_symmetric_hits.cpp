// B18 of docs/hard-cases.md with solver `impulse`: elastic hits at one instant. Momentum to 1e-14, energy to
// 1e-12, and the result has the symmetry of the scene.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace test_symmetric_hits {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5;

template <class Real>
constexpr bool kIsFloat = sizeof(Real) == sizeof(float);

struct Totals {
    double px = 0, py = 0, energy = 0, scale = 0;
};

template <class Real>
Totals totals_of(const Trial<Real>& trial, const Scene& scene) {
    Totals sum;
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
        const double m = *scene.bodies[i].mass;
        const Vec2 v = trial.state(i).velocity;
        sum.px += m * v.x, sum.py += m * v.y;
        sum.energy += m * (v.x * v.x + v.y * v.y) / 2;
        sum.scale += m * std::hypot(v.x, v.y);
    }
    return sum;
}

/// Steps a scene without walls and checks what must not change.
template <class Real>
void run_and_check(Trial<Real>& trial, const Scene& scene, int steps) {
    const Totals before = totals_of(trial, scene);
    trial.run(steps, kStep);
    const Totals after = totals_of(trial, scene);
    const double momentum = (kIsFloat<Real> ? 1e-6 : 1e-14) * before.scale;
    CHECK(std::abs(after.px - before.px) <= momentum);
    CHECK(std::abs(after.py - before.py) <= momentum);
    report("energy changed by ", after.energy / before.energy - 1, ", momentum by ",
           (after.px - before.px) / before.scale);
    CHECK(std::abs(after.energy / before.energy - 1) < (kIsFloat<Real> ? 1e-5 : 1e-12));
    trial.check();
}

/// Bodies i and j are mirror images in the x axis.
template <class Real>
void check_mirrored(const Trial<Real>& trial, std::uint32_t i, std::uint32_t j) {
    const double tolerance = kIsFloat<Real> ? 1e-5 : 1e-12;
    const BodyState a = trial.state(i), b = trial.state(j);
    CAPTURE(i);
    CAPTURE(j);
    CHECK(std::abs(a.position.x - b.position.x) <= tolerance);
    CHECK(std::abs(a.position.y + b.position.y) <= tolerance);
    CHECK(std::abs(a.velocity.x - b.velocity.x) <= tolerance);
    CHECK(std::abs(a.velocity.y + b.velocity.y) <= tolerance);
}

/// A rack of rows 1, 2, ... behind each other along x, `gap` between neighbours, and a ball coming at its
/// tip.
Scene rack(int rows, double gap) {
    Scene scene;
    const double spacing = 2 * kRadius + gap, depth = spacing * std::sqrt(0.75);
    scene.add(disc(kRadius, 1, {-2, 0}, {4, 0}, 1));
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i <= row; ++i)
            scene.add(disc(kRadius, 1, {row * depth, spacing * (i - 0.5 * row)}, {}, 1));
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/symmetric hits") {
    TEST_CASE_TEMPLATE("a ball between two that come from both sides stands still, and they turn round", Real,
                       float, double) {
        for (const double mass : {0.1, 1.0, 50.0}) {
            Scene scene;
            scene.add(disc(kRadius, mass, {0, 0}, {}, 1));
            scene.add(disc(kRadius, 2, {-2, 0}, {3, 0}, 1));
            scene.add(disc(kRadius, 2, {2, 0}, {-3, 0}, 1));
            Trial<Real> trial(scene, {.solver = Solver::impulse});
            run_and_check(trial, scene, 60);
            CHECK(std::abs(trial.state(0).velocity.x) <= (kIsFloat<Real> ? 1e-5 : 1e-13));
            CHECK(trial.state(1).velocity.x == doctest::Approx(-3).epsilon(1e-6));
            CHECK(trial.state(2).velocity.x == doctest::Approx(3).epsilon(1e-6));
        }
    }

    TEST_CASE_TEMPLATE("a ball that hits two at once leaves them mirrored", Real, float, double) {
        for (const double gap : {0.0, 0.01, 0.4}) {
            CAPTURE(gap);
            Scene scene;
            const double aside = kRadius + gap / 2;
            scene.add(disc(kRadius, 1.5, {-3, 0}, {2, 0}, 1));
            scene.add(disc(kRadius, 1, {0, aside}, {}, 1));
            scene.add(disc(kRadius, 1, {0, -aside}, {}, 1));
            Trial<Real> trial(scene, {.solver = Solver::impulse});
            run_and_check(trial, scene, 120);
            check_mirrored(trial, 1, 2);
            CHECK(std::abs(trial.state(0).velocity.y) <= (kIsFloat<Real> ? 1e-6 : 1e-14));
            if (gap < 1e-3) {  // along the lines of centres, 60° apart: one impulse J each, by hand
                const double m = 1.5, v = 2, c = std::sqrt(0.75), j = 2 * v * c / (1 + 2 * c * c / m);
                CHECK(trial.state(1).velocity.x == doctest::Approx(j * c).epsilon(1e-6));
                CHECK(trial.state(1).velocity.y == doctest::Approx(j * 0.5).epsilon(1e-6));
                CHECK(trial.state(0).velocity.x == doctest::Approx(v - 2 * j * c / m).epsilon(1e-6));
            }
        }
    }

    TEST_CASE_TEMPLATE("a triangle rack breaks symmetrically", Real, float, double) {
        for (const int rows : {2, 3, 5})
            for (const double gap : {0.0, 1e-3, 0.05}) {
                CAPTURE(rows);
                CAPTURE(gap);
                const Scene scene = rack(rows, gap);
                Trial<Real> trial(scene, {.solver = Solver::impulse});
                run_and_check(trial, scene, 60);
                CHECK(trial.world.profile().impacts >= rows);
                std::uint32_t first = 1;
                for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
                    for (std::uint32_t i = 0; i <= row / 2; ++i)
                        check_mirrored(trial, first + i, first + row - i);
                    first += row + 1;
                }
            }
    }

    TEST_CASE_TEMPLATE("a ball that runs into a corner comes back the way it came", Real, float, double) {
        for (const double speed : {1.0, 7.0}) {
            Scene scene;
            scene.walls = Walls{.min = {-5, -5}, .max = {5, 5}, .material = bouncy(1)};
            scene.add(disc(kRadius, 1, {2, 2}, {speed, speed}, 1));
            Trial<Real> trial(scene, {.solver = Solver::impulse});
            trial.run(200, kStep);
            const BodyState state = trial.state(0);
            const double tolerance = kIsFloat<Real> ? 1e-4 : 1e-12;
            CHECK(std::abs(state.position.x - state.position.y) <= tolerance);
            CHECK(std::abs(state.velocity.x - state.velocity.y) <= tolerance);
            CHECK(std::abs(std::abs(state.velocity.x) - speed) <= tolerance);
            CHECK(trial.world.profile().wall_impacts > 0);
            CHECK(trial.world.profile().wall_impacts % 2 == 0);
            trial.check();
        }
    }

    TEST_CASE_TEMPLATE("a ball pressed into a corner by another hands its momentum on to both walls", Real,
                       float, double) {
        Scene scene;
        scene.walls = Walls{.min = {-5, -5}, .max = {0, 0}, .material = bouncy(1)};
        scene.add(disc(kRadius, 1, {-kRadius, -kRadius}, {}, 1));  // touches both walls
        scene.add(disc(kRadius, 1, {-2, -2}, {3, 3}, 1));
        Trial<Real> trial(scene, {.solver = Solver::impulse});
        const double start = trial.world.ledger().energy.total();
        trial.run(60, kStep);
        CHECK(std::abs(trial.world.ledger().energy.total() / start - 1) < (kIsFloat<Real> ? 1e-5 : 1e-12));
        for (const std::uint32_t i : {0u, 1u}) {
            const BodyState state = trial.state(i);
            CHECK(std::abs(state.position.x - state.position.y) <= (kIsFloat<Real> ? 1e-5 : 1e-12));
        }
        CHECK(trial.state(1).velocity.x < 0);
        trial.check();
    }
}

}  // namespace test_symmetric_hits

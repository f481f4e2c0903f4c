// A19 of docs/exact-cases.md. Solver `event` as the oracle of impacts under `soft`, for many bodies
// and many impacts a step.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace test_soft_against_event {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

Scene with(Scene scene, Solver solver) {
    scene.accuracy.solver = solver;
    return scene;
}

template <class Real>
void run(BasicWorld<Real>& world, double seconds) {
    for (std::int64_t i = std::llround(seconds / kStep); i > 0; --i) world.step(kStep);
}

/// A ball that breaks 15 others, which touch in a triangle or lie `gap` [m] apart, on a table.
Scene pool(double gap, double restitution, double friction) {
    constexpr double kRadius = 0.5;
    Scene scene;
    scene.walls = Walls{.min = {-20, -20}, .max = {60, 20}, .material = bouncy(restitution)};
    scene.add(disc(kRadius, 1, {-6, 0.013}, {20, 0}, restitution));
    for (int row = 0; row < 5; ++row)
        for (int i = 0; i <= row; ++i)
            scene.add(
                disc(kRadius, 1,
                     {row * (2 * kRadius + gap) * std::sqrt(0.75), (2 * kRadius + gap) * (i - 0.5 * row)}, {},
                     restitution));
    for (Body& body : scene.bodies) body.material.friction = friction;
    return scene;
}

}  // namespace

TEST_SUITE("physics/soft against event") {
    TEST_CASE("with gaps a pool break makes the impacts of event, to round-off, in few steps or many") {
        for (const double restitution : {1.0, 0.9})
            for (const double friction : {0.0, 0.2}) {
                const Scene scene = pool(0.01, restitution, friction);
                constexpr double kTime = 0.4;  // s: the triangle is broken
                World64 exact(with(scene, Solver::event));
                exact.step(kTime);
                REQUIRE(exact.profile().impacts > 15);
                for (const int steps : {12, 24, 96}) {
                    World64 soft(with(scene, Solver::soft), {.threads = 1});
                    for (int i = 0; i < steps; ++i) soft.step(kTime / steps);
                    double farthest = 0;
                    for (std::uint32_t i = 0; i < exact.body_count(); ++i) {
                        const Vec2 p = exact.state({i, 0}).position, q = soft.state({i, 0}).position;
                        farthest = std::max(farthest, std::hypot(p.x - q.x, p.y - q.y));
                    }
                    CAPTURE(restitution);
                    CAPTURE(friction);
                    CAPTURE(steps);
                    report("restitution ", restitution, ", friction ", friction, ", ", steps,
                           " steps: impacts ", soft.profile().impacts, " of ", exact.profile().impacts,
                           ", farthest apart ", farthest, " m, energy ",
                           soft.ledger().energy.total() / exact.ledger().energy.total());
                    CHECK(soft.profile().impacts == exact.profile().impacts);
                    CHECK(farthest < 1e-9);
                }
            }
    }

    TEST_CASE_TEMPLATE("a pool break of touching balls keeps its energy, or loses what event loses", Real,
                       float, double) {
        for (const double restitution : {1.0, 0.95}) {
            BasicWorld<Real> soft(with(pool(0, restitution, 0), Solver::soft), {.threads = 1});
            // event takes impacts that follow each other at once for a collapse, so it gets gaps
            World64 exact(with(pool(1e-3, restitution, 0), Solver::event));
            const double start = soft.ledger().energy.total();
            run(soft, 1), exact.step(1);
            const double energy = soft.ledger().energy.total() / start,
                         expected = exact.ledger().energy.total() / start;
            report("restitution ", restitution, ": energy ", energy, " of the first, event ", expected,
                   ", impacts ", soft.profile().impacts, " and ", exact.profile().impacts);
            CAPTURE(restitution);
            if (restitution == 1)
                CHECK(std::abs(energy - 1) < (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12));
            else
                CHECK(std::abs(energy / expected - 1) < 0.05);
        }
    }

    TEST_CASE_TEMPLATE("an elastic gas keeps its energy and has the collision rate and pressure of event",
                       Real, float, double) {
        for (const double eta : {0.2, 0.4, 0.6}) {
            const Scene scene = gas_scene({.count = 1000, .packing_fraction = eta});
            BasicWorld<Real> soft(with(scene, Solver::soft), {.threads = 1, .effects = {.ledger = true}});
            World64 exact(with(scene, Solver::event), {.threads = 1});
            const Ledger start = soft.ledger();
            const double seconds = scaled(8.0, 2.0);
            run(soft, seconds), exact.step(seconds);
            const double energy = soft.ledger().energy.total() / start.energy.total() - 1,
                         impacts = static_cast<double>(soft.profile().impacts) /
                                   static_cast<double>(exact.profile().impacts),
                         pressure = soft.ledger().wall_impulse / exact.ledger().wall_impulse;
            report("fill ", eta, ": energy off by ", energy, ", impacts ", impacts, " of ",
                   exact.profile().impacts, ", pressure ", pressure, ", overlap ", soft.overlaps().max,
                   " m, inelastic ", soft.profile().impacts - soft.profile().bounces);
            CAPTURE(eta);
            CHECK(std::abs(energy) < (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12));
            CHECK(std::abs(impacts - 1) < scaled(0.02, 0.03));
            CHECK(std::abs(pressure - 1) < scaled(0.05, 0.1));
            CHECK(soft.profile().bounces == soft.profile().impacts);
            CHECK(soft.overlaps().max < 1e-3 * 0.5);
            check_books_close(soft, 1000);
        }
    }

    TEST_CASE_TEMPLATE("an inelastic gas cools as event does", Real, float, double) {
        for (const double restitution : {0.95, 0.8}) {
            Scene scene = gas_scene({.count = 1000, .packing_fraction = 0.4, .restitution = restitution});
            scene.walls->material.restitution = 1;
            BasicWorld<Real> soft(with(scene, Solver::soft), {.threads = 1});
            World64 exact(with(scene, Solver::event), {.threads = 1});
            for (int second = 1; second <= 4; ++second) {
                run(soft, 1), exact.step(1);
                const double energy = soft.ledger().energy.total() / exact.ledger().energy.total();
                report("restitution ", restitution, ", ", second, " s: energy ", energy, " of ",
                       exact.ledger().energy.total(), " J, impacts ", soft.profile().impacts, " of ",
                       exact.profile().impacts, ", inelastic ",
                       soft.profile().impacts - soft.profile().bounces);
                CAPTURE(restitution);
                CAPTURE(second);
                CHECK(std::abs(energy - 1) < 0.03);
            }
        }
    }
}

}  // namespace test_soft_against_event

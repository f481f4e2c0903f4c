// B4 of docs/hard-cases.md, with discs: a heavy disc on a light one.
#include "support/hard_case.hpp"
#include "support/passive_run.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace test_heavy_on_light {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5, kGravity = 10, kStep = 1.0 / 60;

/// A disc on another of the same size, beside its top by an angle from the vertical. Rolling resistance moves
/// the normal force in either contact by c times R = r / 2 and r, so that both hold while sin(angle) <= c
/// / 2.
template <class Real>
Vec2 on_top_after(double seconds, double ratio, double angle, double rolling_resistance) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_at(0);
    scene.walls->material = {.friction = 1, .rolling_resistance = rolling_resistance};
    scene.accuracy.solver = Solver::soft;
    scene.add(disc(kRadius, 1, {0, kRadius}));
    scene.add(disc(kRadius, ratio, {2 * kRadius * std::sin(angle), kRadius + 2 * kRadius * std::cos(angle)}));
    for (Body& body : scene.bodies) body.material = {.friction = 1, .rolling_resistance = rolling_resistance};
    PassiveRun<Real> run(scene);
    for (int i = 0; i < std::lround(seconds / kStep); ++i) run.step(kStep);
    run.check();
    report("ratio ", ratio, ", angle ", angle, ": moved by ",
           run.state(1).position.x - scene.bodies[1].position.x, " m");
    return run.state(1).position;
}

}  // namespace

TEST_SUITE("hard cases/heavy on light") {
    TEST_CASE_TEMPLATE("B4: a light disc carries one that is up to a million times heavier", Real, float,
                       double) {
        check_cases<Real>(torture::discs_under_a_heavy_one(extent()), Twin::other_order);
    }

    TEST_CASE_TEMPLATE("a light disc stops one that falls on it", Real, float, double) {
        check_cases<Real>(torture::discs_hit_by_a_heavy_one(extent()), Twin::other_order);
    }

    TEST_CASE_TEMPLATE("columns of light discs carry heavy ones", Real, float, double) {
        check_cases<Real>(torture::columns_under_a_heavy_disc(extent()), Twin::other_order);
    }

    // What is solved beside the sweeps obeys the same laws.
    TEST_CASE_TEMPLATE("a heavy disc that hits light ones keeps momentum and gains no energy", Real, float,
                       double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.add(disc(kRadius, 1e4, {0, 0}, {3, 0.2}));
        for (int i = 0; i < 12; ++i)
            scene.add(disc(0.3 * kRadius, 1 + 0.1 * i, {2 + 0.31 * (i % 4), 0.32 * (i / 4) - 0.3}));
        for (Body& body : scene.bodies) body.material.friction = 0.3;
        BasicWorld<Real> world(scene, {.threads = 1, .effects = {.ledger = true}});
        const Ledger start = world.ledger();
        for (int i = 0; i < 120; ++i) world.step(kStep);
        const Ledger end = world.ledger();
        // In single precision each of 480 substeps rounds the heavy one's speed by up to 1e-7 of it.
        const double round_off = sizeof(Real) == 4 ? 3e-6 : 1e-14, momentum = 3e4;
        const double off_x = (end.momentum.x - start.momentum.x) / momentum,
                     off_y = (end.momentum.y - start.momentum.y) / momentum;
        report("momentum off by ", off_x, ", ", off_y, " of it, energy ",
               end.energy.total() / start.energy.total(), " of that at the start, unexplained ",
               end.energy_by_cause.unexplained / start.energy.total());
        CHECK(std::fabs(off_x) < round_off);
        CHECK(std::fabs(off_y) < round_off);
        CHECK(end.energy.total() <= start.energy.total() * (1 + round_off));
        CHECK(std::fabs(end.energy_by_cause.unexplained) < 10 * round_off * start.energy.total());
        CHECK(world.state({1, 0}).velocity.x > 1);  // they were hit
    }

    TEST_CASE_TEMPLATE("rolling resistance balances a heavy disc on a light one as far as its arm reaches",
                       Real, float, double) {
        constexpr double kRolling = 0.2, kHeld = 0.05, kLost = 0.15;  // sin(angle) <= 0.1
        for (const double ratio : {1.0, 100.0, 1e4}) {
            CAPTURE(ratio);
            CHECK(on_top_after<Real>(10, ratio, kHeld, kRolling).x ==
                  doctest::Approx(2 * kRadius * std::sin(kHeld)).epsilon(0.02));
            CHECK(on_top_after<Real>(10, ratio, kLost, kRolling).y < 1.1 * kRadius);
        }
    }
}

}  // namespace test_heavy_on_light

// B7 and B8 of docs/hard-cases.md: bodies that start inside each other come apart, no faster than the cap,
// and their velocities learn nothing of it. What it costs against gravity is booked as correction.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace test_overlaps {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5;
constexpr double kPushCap = 6 * kRadius;  // m/s: six radii a second, 3 m/s for these discs
constexpr double kOverlapLeft = 0.01;     // of the radius, what counts as apart
constexpr int kTwoSeconds = 120;

template <class Real>
double fastest(const BasicWorld<Real>& world) {
    const BodyView<Real> bodies = world.bodies();
    double speed = 0;
    for (std::size_t row = 0; row < bodies.count; ++row)
        speed = std::max(speed, std::hypot(static_cast<double>(bodies.velocity_x[row]),
                                           static_cast<double>(bodies.velocity_y[row])));
    return speed;
}

template <class Real>
std::vector<Vec2> positions(const BasicWorld<Real>& world) {
    std::vector<Vec2> places(world.body_count());
    for (std::uint32_t i = 0; i < places.size(); ++i) places[i] = world.state({i, 0}).position;
    return places;
}

double distance(Vec2 a, Vec2 b) {
    return std::hypot(b.x - a.x, b.y - a.y);
}

/// Steps for two seconds; returns the fastest that any disc was moved [m/s].
template <class Real>
double push_apart(Trial<Real>& trial) {
    double speed = 0;
    for (int i = 0; i < kTwoSeconds; ++i) {
        const std::vector<Vec2> before = positions(trial.world);
        trial.step(kStep);
        const std::vector<Vec2> after = positions(trial.world);
        for (std::size_t b = 0; b < after.size(); ++b) {
            REQUIRE(std::isfinite(after[b].x + after[b].y));
            speed = std::max(speed, distance(before[b], after[b]) / kStep);
        }
    }
    return speed;
}

Scene coincident(int count, Vec2 at, double mass_ratio = 1) {
    Scene scene;
    for (int i = 0; i < count; ++i) scene.add(disc(kRadius, i == 0 ? mass_ratio : 1, at));
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/overlaps") {
    TEST_CASE_TEMPLATE("two coincident discs come apart the same way every time, without speed", Real, float,
                       double) {
        for (const Vec2 at : {Vec2{0, 0}, Vec2{-123.25, 77.5}}) {
            Trial<Real> first(coincident(2, at)), again(coincident(2, at));
            const double speed = push_apart(first);
            push_apart(again);
            CHECK(first.world.state_hash() == again.world.state_hash());
            const Vec2 a = first.state(0).position, b = first.state(1).position;
            CHECK(distance(a, b) > 2 * kRadius - kOverlapLeft * kRadius);
            CHECK(distance(a, b) < 2 * kRadius * (1 + 1e-6));
            CHECK(std::abs(a.x + b.x - 2 * at.x) < 1e-4 * kRadius);  // the centre of mass stays
            CHECK(std::abs(a.y + b.y - 2 * at.y) < 1e-4 * kRadius);
            CHECK(speed <= kPushCap * (1 + 1e-3));
            CHECK(fastest(first.world) == 0);
            first.check(1);
        }
    }

    TEST_CASE_TEMPLATE("a thousand coincident discs come apart within two seconds, without speed", Real,
                       float, double) {
        const int kDiscs = scaled(1000, 200);
        Scene scene = coincident(kDiscs, {3, -2});
        double left = kOverlapLeft;  // after a second more
        SUBCASE("solver auto") {
            left = 3 * kOverlapLeft;
        }
        SUBCASE("solver impulse") {
            scene.accuracy.solver = Solver::impulse;
        }
        Trial<Real> first(scene);
        const double speed = push_apart(first);
        BasicWorld<Real> again(scene);
        for (int i = 0; i < kTwoSeconds; ++i) again.step(kStep);
        CHECK(first.world.state_hash() == again.state_hash());
        const OverlapReport overlaps = first.world.overlaps();
        report(kDiscs, " coincident discs: largest overlap after 2 s ", overlaps.max, ", mean ",
               overlaps.mean, ", moved at most at ", speed, " m/s");
        CHECK(overlaps.mean < kOverlapLeft);
        CHECK(overlaps.max < 5 * kOverlapLeft);
        first.run(60, kStep);
        CHECK(first.world.overlaps().max < left);
        CHECK(fastest(first.world) == 0);
        Vec2 centre;
        for (const Vec2 place : positions(first.world))
            centre.x += place.x / kDiscs, centre.y += place.y / kDiscs;
        CHECK(std::abs(centre.x - 3) < 1e-3);
        CHECK(std::abs(centre.y + 2) < 1e-3);
        first.check(1);
    }

    TEST_CASE_TEMPLATE(
        "solver soft: a thousand coincident discs come apart within two seconds, without speed", Real, float,
        double) {
        const int kDiscs = scaled(1000, 200);
        Scene scene = coincident(kDiscs, {3, -2});
        scene.accuracy.solver = Solver::soft;
        BasicWorld<Real> first(scene, {.threads = 1}), again(scene, {.threads = 2});
        for (int i = 0; i < kTwoSeconds; ++i) {
            first.step(kStep), again.step(kStep);
            REQUIRE(fastest(first) == 0);
        }
        CHECK(first.state_hash() == again.state_hash());
        const OverlapReport overlaps = first.overlaps();
        report(kDiscs, " coincident discs, soft: largest overlap after 2 s ", overlaps.max, ", mean ",
               overlaps.mean);
        CHECK(overlaps.mean < kOverlapLeft);
        CHECK(overlaps.max < 10 * kOverlapLeft);
        Vec2 centre;
        for (const Vec2 place : positions(first)) centre.x += place.x / kDiscs, centre.y += place.y / kDiscs;
        CHECK(std::abs(centre.x - 3) < 1e-3);
        CHECK(std::abs(centre.y + 2) < 1e-3);
        CHECK(first.quarantined().empty());
    }

    TEST_CASE_TEMPLATE("solver soft: two coincident discs come apart, no faster than the cap", Real, float,
                       double) {
        Scene scene = coincident(2, {-123.25, 77.5});
        scene.accuracy.solver = Solver::soft;
        BasicWorld<Real> world(scene, {.threads = 1});
        double apart = 0;
        for (int i = 0; i < kTwoSeconds; ++i) {
            world.step(kStep);
            const double now = distance(world.state({0, 0}).position, world.state({1, 0}).position);
            CHECK(now - apart <= kPushCap * kStep * (1 + 1e-3));
            apart = now;
        }
        CHECK(fastest(world) == 0);
        CHECK(apart > 2 * kRadius - kOverlapLeft * kRadius);
        CHECK(apart < 2 * kRadius * (1 + 1e-6));
    }

    TEST_CASE_TEMPLATE("overlapping discs are pushed apart by mass, below the cap, and gain no speed", Real,
                       float, double) {
        for (const double overlap : {0.25, 0.5, 0.9})  // of the smaller disc's diameter
            for (const double ratio : {1.0, 1e-3, 1e6}) {
                CAPTURE(overlap);
                CAPTURE(ratio);
                constexpr double kSmall = 0.2;
                Scene scene;
                const double apart = kRadius + kSmall - 2 * kSmall * overlap;
                scene.add(disc(kRadius, 1, {0, 0}));
                scene.add(disc(kSmall, ratio, {0.6 * apart, 0.8 * apart}));
                Trial<Real> trial(scene);
                const double speed = push_apart(trial);
                CHECK(speed <= 6 * kSmall * (1 + 1e-3));
                const Vec2 a = trial.state(0).position, b = trial.state(1).position;
                CHECK(distance(a, b) > kRadius + kSmall - kOverlapLeft * kSmall);
                CHECK(fastest(trial.world) == 0);
                const double mass = 1 + ratio;
                CHECK(std::abs(a.x + ratio * b.x - ratio * 0.6 * apart) < 1e-5 * mass);
                CHECK(std::abs(a.y + ratio * b.y - ratio * 0.8 * apart) < 1e-5 * mass);
                trial.check(1);
            }
    }

    TEST_CASE_TEMPLATE("a disc half inside the floor is lifted out, and the ledger says at what cost", Real,
                       float, double) {
        for (const double overlap : {0.25, 0.5, 0.9}) {
            CAPTURE(overlap);
            Scene scene;
            scene.gravity = {0, -10};
            scene.walls = floor_at(0, 1);
            const double start = kRadius * (1 - 2 * overlap);
            Body body = disc(kRadius, 2, {0, std::max(start, 0.0)}, {}, 1);
            scene.add(body);
            Trial<Real> trial(scene);
            const double speed = push_apart(trial);
            CHECK(speed <= kPushCap * (1 + 1e-3));
            const BodyState state = trial.state(0);
            CHECK(std::abs(state.position.y - kRadius) < kOverlapLeft * kRadius);
            CHECK(std::abs(state.velocity.y) < 1e-6);
            const double lifted = state.position.y - body.position.y;
            const EnergyByCause by = trial.all_on.ledger().energy_by_cause;
            CHECK(by.correction == doctest::Approx(2 * 10 * lifted).epsilon(0.02));
            trial.check(2 * 10 * kRadius);
        }
    }

    TEST_CASE_TEMPLATE("moving discs that overlap leave as fast as they would without", Real, float, double) {
        // Apart already by their velocities: nothing may be added. Approaching: one impact, nothing more.
        for (const double speed : {1.0, -1.0}) {
            Scene scene;
            scene.add(disc(kRadius, 1, {0, 0}, {-speed, 0}, 1));
            scene.add(disc(kRadius, 1, {0.5, 0}, {speed, 0}, 1));
            Trial<Real> trial(scene);
            push_apart(trial);
            CHECK(trial.state(0).velocity.x == -1);
            CHECK(trial.state(1).velocity.x == 1);
            trial.check();
        }
    }

    // The lower one cannot give way, the upper one falls by g dt² / 2 within the step.
    TEST_CASE_TEMPLATE("under solver soft a disc that is let go just above another one ends no step in it",
                       Real, float, double) {
        constexpr double kFall = 10;
        struct Case {
            double radius, dt;
        };
        for (const Case& c : {Case{0.01, 1.0 / 60}, Case{0.005, 1.0 / 60}, Case{0.5, 0.1}, Case{0.1, 0.05}})
            for (int share = 1; share <= 20; ++share) {
                const double gap = 0.05 * share * 0.5 * kFall * c.dt * c.dt;
                Scene scene;
                scene.gravity = {0, -kFall};
                scene.accuracy.solver = Solver::soft;
                scene.walls = floor_at(0);
                scene.add(disc(c.radius, 1, {0, c.radius}));
                scene.add(disc(c.radius, 1, {0, 3 * c.radius + gap}));
                BasicWorld<Real> world(scene);
                CAPTURE(c.radius);
                CAPTURE(gap / c.radius);
                double deepest = 0;
                for (int i = 0; i < 10; ++i) {
                    world.step(c.dt);
                    deepest = std::fmax(deepest, world.overlaps().max);
                }
                CHECK(deepest < 0.01);
            }
    }
}

}  // namespace test_overlaps

// A15, A16, A17 and A18 of docs/exact-cases.md: impacts along a line, with answers in closed form.
#include "support/effort.hpp"
#include "support/event_simulation.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace test_impacts_in_line {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr Solver kSolvers[] = {Solver::impulse, Solver::soft};

template <class Real>
constexpr double kExact = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-13;  // relative

struct Speeds {
    double first, second;
};

/// v1' = ((m1 - e m2) v1 + (1 + e) m2 v2) / (m1 + m2), and the same with 1 and 2 exchanged.
Speeds after_impact(double m1, double v1, double m2, double v2, double e) {
    const double mass = m1 + m2;
    return {((m1 - e * m2) * v1 + (1 + e) * m2 * v2) / mass, ((m2 - e * m1) * v2 + (1 + e) * m1 * v1) / mass};
}

}  // namespace

TEST_SUITE("physics/impacts in line") {
    TEST_CASE_TEMPLATE("two bodies in line leave with the velocities of the impact formula", Real, float,
                       double) {
        for (const Solver solver : kSolvers)
            for (const double ratio : {1e-6, 1e-2, 0.5, 1.0, 7.0, 1e4})
                for (const double e : {0.0, 0.25, 0.5, 0.9, 1.0})
                    for (const double v2 : {0.0, -1.5, 1.0}) {
                        CAPTURE(ratio);
                        CAPTURE(e);
                        CAPTURE(v2);
                        CAPTURE(name_of(solver));
                        if (solver == Solver::soft && e == 0) continue;
                        Scene scene;
                        scene.accuracy.solver = solver;
                        scene.add(disc(0.5, 1, {-1, 3}, {2, 0}, e));
                        scene.add(disc(0.25, ratio, {0, 3}, {v2, 0}, e));
                        Trial<Real> trial(scene);
                        trial.run(60, kStep);
                        const double mass = static_cast<double>(static_cast<Real>(ratio));
                        const double restitution = static_cast<double>(static_cast<Real>(e));
                        const Speeds exact = after_impact(1, 2, mass, v2, restitution);
                        const double largest = std::fmax(std::abs(exact.first), std::abs(exact.second));
                        CHECK(std::abs(trial.state(0).velocity.x - exact.first) <= kExact<Real> * largest);
                        CHECK(std::abs(trial.state(1).velocity.x - exact.second) <= kExact<Real> * largest);
                        if (e > 0) CHECK(trial.world.profile().impacts == 1);  // else they stay in touch
                        trial.check();
                    }
    }

    TEST_CASE_TEMPLATE("a shock runs down a chain of unequal bodies as the impact formula says", Real, float,
                       double) {
        // Falling masses: each body flies off faster than the one that hit it, so each pair meets once.
        constexpr int kBodies = 12;
        constexpr double kRatio = 0.8, e = 0.9;
        for (const Solver solver : kSolvers)
            for (const double dt : {kStep, 1.0 / 3}) {  // one impact a step; several in a step
                CAPTURE(name_of(solver));
                CAPTURE(dt);
                Scene scene;
                scene.accuracy.solver = solver;
                double mass = 1;
                std::vector<double> masses;
                for (int i = 0; i < kBodies; ++i) {
                    masses.push_back(static_cast<Real>(mass));
                    scene.add(disc(0.5, mass, {1.1 * i, 0}, {i == 0 ? 1.0 : 0.0, 0}, e));
                    mass *= kRatio;
                }
                Trial<Real> trial(scene);
                trial.run(static_cast<int>(std::lround(3 / dt)), dt);
                double incoming = 1;
                for (int i = 0; i + 1 < kBodies; ++i) {
                    const auto n = static_cast<std::size_t>(i);
                    const Speeds exact =
                        after_impact(masses[n], incoming, masses[n + 1], 0, static_cast<double>(Real(e)));
                    CAPTURE(i);
                    CHECK(std::abs(trial.state(static_cast<std::uint32_t>(i)).velocity.x - exact.first) <=
                          10 * kExact<Real>);
                    incoming = exact.second;
                }
                CHECK(std::abs(trial.state(kBodies - 1).velocity.x - incoming) <= 10 * kExact<Real>);
                CHECK(trial.world.profile().impacts == kBodies - 1);
                trial.check();
            }
    }

    TEST_CASE_TEMPLATE("solvers event and soft leave pairs and the chain with the same velocities", Real,
                       float, double) {
        for (const Solver solver : {Solver::event, Solver::soft})
            for (const double ratio : {1e-2, 0.5, 1.0, 7.0, 1e2})
                for (const double e : {0.0, 0.5, 1.0}) {
                    CAPTURE(name_of(solver));
                    CAPTURE(ratio);
                    CAPTURE(e);
                    Scene scene;
                    scene.accuracy.solver = solver;
                    scene.add(disc(0.5, 1, {-1, 3}, {2, 0}, e));
                    scene.add(disc(0.25, ratio, {0, 3}, {-1.5, 0}, e));
                    BasicWorld<Real> world(scene);
                    for (int i = 0; i < 60; ++i) world.step(kStep);
                    const Speeds exact = after_impact(1, 2, static_cast<double>(Real(ratio)), -1.5, e);
                    CHECK(std::abs(world.state({0, 0}).velocity.x - exact.first) <= 4 * kExact<Real>);
                    CHECK(std::abs(world.state({1, 0}).velocity.x - exact.second) <= 4 * kExact<Real>);
                }
        constexpr int kBodies = 12;
        constexpr double kRatio = 0.8, e = 0.9;
        for (const Solver solver : {Solver::event, Solver::soft}) {
            CAPTURE(name_of(solver));
            Scene scene;
            scene.accuracy.solver = solver;
            std::vector<double> masses;
            for (int i = 0; i < kBodies; ++i) {
                masses.push_back(static_cast<Real>(std::pow(kRatio, i)));
                scene.add(disc(0.5, std::pow(kRatio, i), {1.1 * i, 0}, {i == 0 ? 1.0 : 0.0, 0}, e));
            }
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 180; ++i) world.step(kStep);
            double incoming = 1;
            for (std::uint32_t i = 0; i + 1 < kBodies; ++i) {
                const Speeds exact =
                    after_impact(masses[i], incoming, masses[i + 1], 0, static_cast<double>(Real(e)));
                CAPTURE(i);
                CHECK(std::abs(world.state({i, 0}).velocity.x - exact.first) <= 10 * kExact<Real>);
                incoming = exact.second;
            }
            CHECK(std::abs(world.state({kBodies - 1, 0}).velocity.x - incoming) <= 10 * kExact<Real>);
        }
    }

    TEST_CASE_TEMPLATE("two balls and a wall collide as often as pi has digits: 3, 31 and 314 times", Real,
                       float, double) {
        // Galperin, "Playing pool with pi", 2003: masses 1 and 100^k collide floor(pi 10^k) times.
        const std::array<std::int64_t, 3> expected{3, 31, 314};
        for (const Solver solver : kSolvers) {
            double mass = 1;
            for (const std::int64_t collisions : expected) {
                for (const double dt : scaled<std::vector<double>>({kStep, 1.0 / 240, 0.5}, {kStep, 0.5})) {
                    CAPTURE(name_of(solver));
                    CAPTURE(mass);
                    CAPTURE(dt);
                    Trial<Real> trial(galperin_billiard(mass, solver));
                    trial.run(static_cast<int>(std::lround(60 / dt)), dt);
                    CHECK(trial.world.profile().impacts == collisions);
                    const BodyState light = trial.state(0), heavy = trial.state(1);
                    CHECK(heavy.velocity.x > 0);
                    CHECK(light.velocity.x <= heavy.velocity.x);  // they will not meet again
                    CHECK(light.velocity.x >= 0);                 // nor will the wall be hit again
                    const double energy =
                        (light.velocity.x * light.velocity.x + mass * heavy.velocity.x * heavy.velocity.x) /
                        mass;
                    CHECK(std::abs(energy - 1) <= 100 * kExact<Real>);
                    trial.check();
                }
                mass *= 100;
            }
        }
    }

    TEST_CASE("in double precision masses 1 and 1,000,000 collide 3141 times") {
        for (const Solver solver : kSolvers) {
            Trial<double> trial(galperin_billiard(1e6, solver));
            trial.run(360, kStep);
            CAPTURE(name_of(solver));
            CHECK(trial.world.profile().impacts == 3141);
            trial.check();
        }
    }

    TEST_CASE_TEMPLATE("of five balls in line as many leave as came, at their speed, and the rest stand",
                       Real, float, double) {
        for (const Solver solver : kSolvers)
            for (const double friction : {0.0, 0.2})
                for (const int moving : {1, 2, 3, 4})
                    for (const double gap : {0.1, 1e-3, 0.0}) {
                        CAPTURE(name_of(solver));
                        CAPTURE(friction);
                        CAPTURE(moving);
                        CAPTURE(gap);
                        Trial<Real> trial(cradle(moving, gap, solver, friction));
                        trial.run(90, kStep);
                        for (int i = 0; i < 5; ++i) {
                            CAPTURE(i);
                            const double speed = i >= 5 - moving ? 2.0 : 0.0;
                            CHECK(std::abs(trial.state(static_cast<std::uint32_t>(i)).velocity.x - speed) <=
                                  2 * kExact<Real>);
                        }
                        CHECK(trial.world.profile().impacts == moving * (5 - moving));
                        trial.check();
                    }
    }

    TEST_CASE_TEMPLATE("a light ball on a heavy one is thrown up with (3M - m) / (M + m) of their speed",
                       Real, float, double) {
        constexpr double kGravity = 9.81, kHeight = 1, kLow = 0.5, kHigh = 0.2;  // m
        for (const double light : {0.01, 0.1, 0.25})  // a heavier one would throw the lower ball back down
            for (const Solver solver : kSolvers)
                for (const double gap : {0.0, 1e-3, 0.05}) {
                    CAPTURE(name_of(solver));
                    CAPTURE(light);
                    CAPTURE(gap);
                    Scene scene;
                    scene.accuracy.solver = solver;
                    scene.gravity = {0, -kGravity};
                    scene.walls = floor_at(0, 1);
                    scene.add(disc(kLow, 1, {0, kHeight + kLow}, {}, 1));
                    scene.add(disc(kHigh, light, {0, kHeight + 2 * kLow + gap + kHigh}, {}, 1));
                    Trial<Real> trial(scene);
                    trial.run(30, kStep);

                    // The heavy ball turns round at v, then both approach at 2 v until the gap is closed.
                    const double v = std::sqrt(2 * kGravity * kHeight), wait = gap / (2 * v);
                    const double m = static_cast<double>(static_cast<Real>(light));
                    const Speeds exact = after_impact(1, v - kGravity * wait, m, -v - kGravity * wait, 1);
                    if (gap == 0)
                        CHECK(exact.second == doctest::Approx((3 - m) / (1 + m) * v).epsilon(1e-14));
                    const double fall = 0.5 - v / kGravity - wait;  // s, since they met
                    const double low = exact.first - kGravity * fall, high = exact.second - kGravity * fall;
                    const double tolerance = (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12) * v;
                    CHECK(std::abs(trial.state(0).velocity.y - low) <= tolerance);
                    CHECK(std::abs(trial.state(1).velocity.y - high) <= tolerance);
                    trial.check(2 * kGravity * kHeight);
                }
    }
}

}  // namespace test_impacts_in_line

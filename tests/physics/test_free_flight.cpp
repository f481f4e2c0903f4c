// A1, A2 and, for 600 steps, A36 of docs/exact-cases.md: flight under gravity and linear drag, and free spin.
// The engine solves it exactly, so there is no order of convergence to observe: the error must be round-off
// at every step length. The exception is the angle of solver `soft`.
#include "support/convergence.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace test_free_flight {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kSeconds = 2;
constexpr Vec2 kStart{1, 2}, kVelocity{3, 7}, kGravity{0.5, -9.81};

const std::vector<int> kStepsASecond{1, 4, 10, 60, 240, 1000};

/// What rounding the state once a step can add up to, for numbers of `size`.
template <class Real>
double rounding_of(int steps, double size) {
    return 4 * kRounding<Real> * size * (steps + 1);
}

Scene projectile(double drag) {
    Scene scene;
    scene.accuracy.solver = Solver::impulse;
    scene.gravity = kGravity;
    scene.drag.linear = drag;
    scene.add(disc(0.5, 2, kStart, kVelocity));
    return scene;
}

/// Steps a projectile for kSeconds and compares it with where it has to be.
template <class Real>
void check_flight(double drag, Vec2 position, Vec2 velocity) {
    for (const int rate : kStepsASecond) {
        CAPTURE(drag);
        CAPTURE(rate);
        Trial<Real> trial(projectile(drag));
        const int steps = static_cast<int>(kSeconds * rate);
        trial.run(steps, 1.0 / rate);
        const BodyState state = trial.state(0);
        CHECK(std::abs(state.position.x - position.x) <= rounding_of<Real>(steps, 20));
        CHECK(std::abs(state.position.y - position.y) <= rounding_of<Real>(steps, 20));
        CHECK(std::abs(state.velocity.x - velocity.x) <= rounding_of<Real>(steps, 20));
        CHECK(std::abs(state.velocity.y - velocity.y) <= rounding_of<Real>(steps, 20));
        trial.check();
    }
}

}  // namespace

TEST_SUITE("physics/free flight") {
    TEST_CASE_TEMPLATE("a projectile flies an exact parabola at every step length", Real, float, double) {
        const double t = kSeconds;
        check_flight<Real>(0,
                           {kStart.x + kVelocity.x * t + kGravity.x * t * t / 2,
                            kStart.y + kVelocity.y * t + kGravity.y * t * t / 2},
                           {kVelocity.x + kGravity.x * t, kVelocity.y + kGravity.y * t});
    }

    TEST_CASE_TEMPLATE("a projectile with linear drag is exact at every step length", Real, float, double) {
        for (const double k : {1e-6, 0.1, 1.2626692073449666, 30.0}) {
            // v' = g - k v
            const double decay = std::exp(-k * kSeconds), s = -std::expm1(-k * kSeconds) / k;
            // (t - s) / k cancels for small k t: its series instead
            const double t = kSeconds;
            const double q = k * t < 1e-3 ? t * t * (0.5 - k * t / 6 + k * t * k * t / 24) : (t - s) / k;
            check_flight<Real>(
                k, {kStart.x + kVelocity.x * s + kGravity.x * q, kStart.y + kVelocity.y * s + kGravity.y * q},
                {kVelocity.x * decay + kGravity.x * s, kVelocity.y * decay + kGravity.y * s});
        }
    }

    TEST_CASE_TEMPLATE("gravity leaves the speed across it alone, to the last bit", Real, float, double) {
        Scene scene = projectile(0);
        scene.gravity = {0, -9.81};
        Trial<Real> trial(scene);
        trial.run(2000, 1e-3);
        CHECK(trial.state(0).velocity.x == kVelocity.x);
    }

    TEST_CASE_TEMPLATE("drag alone slows a body and its spin by exp(-k t) whatever the step", Real, float,
                       double) {
        constexpr double kLinear = 1.7, kAngular = 0.6;
        for (const int rate : kStepsASecond) {
            CAPTURE(rate);
            Scene scene;
            scene.accuracy.solver = Solver::impulse;
            scene.drag = {kLinear, kAngular};
            Body body = disc(0.5, 2, {}, {3, -4});
            body.angle = 0.25;
            body.angular_velocity = 5;
            scene.add(body);
            Trial<Real> trial(scene);
            const int steps = static_cast<int>(kSeconds * rate);
            trial.run(steps, 1.0 / rate);
            const BodyState state = trial.state(0);
            const double rounding = rounding_of<Real>(steps, 5);
            const double linear = std::exp(-kLinear * kSeconds), angular = std::exp(-kAngular * kSeconds);
            CHECK(std::abs(state.velocity.x - 3 * linear) <= rounding);
            CHECK(std::abs(state.velocity.y + 4 * linear) <= rounding);
            CHECK(std::abs(state.angular_velocity - 5 * angular) <= rounding);
            CHECK(std::abs(state.angle - 0.25 - 5 * (1 - angular) / kAngular) <=
                  rounding_of<Real>(steps, 10));
            trial.check();
        }
    }

    TEST_CASE("under solver soft the angle of a spin that angular drag slows converges with second order") {
        constexpr double kDrag = 0.6, kSpin = 5;
        const double turn = -kSpin * std::expm1(-kDrag * kSeconds) / kDrag;
        std::vector<double> steps, errors;
        for (const int rate : {2, 4, 8, 16, 32}) {
            Scene scene;
            scene.drag.angular = kDrag;
            scene.accuracy.solver = Solver::soft;
            scene.accuracy.substeps = 1;
            Body body = disc(0.5, 2, {});
            body.angular_velocity = kSpin;
            scene.add(body);
            Trial<double> trial(scene);
            trial.run(static_cast<int>(kSeconds * rate), 1.0 / rate);
            steps.push_back(1.0 / rate);
            errors.push_back(std::abs(trial.state(0).angle - turn));
            trial.check();
        }
        const double order = observed_order(steps, errors);
        report("order ", order, ", error at 1/2 s ", errors.front(), ", at 1/32 s ", errors.back());
        CHECK(order > 1.95);
        CHECK(order < 2.05);
    }

    TEST_CASE_TEMPLATE("under solver soft a spin that nothing changes turns by its rate times the time", Real,
                       float, double) {
        for (const double drag : {0.0, 0.3}) {
            Scene scene;
            scene.gravity = kGravity;
            scene.drag.linear = drag;
            scene.accuracy.solver = Solver::soft;
            Body body = disc(0.5, 2, {});
            body.angular_velocity = 7.25;  // sums of turns of 1/64 s have no rounding
            scene.add(body);
            Trial<Real> trial(scene);
            trial.run(128, 1.0 / 64);
            CHECK(trial.state(0).angular_velocity == 7.25);
            CHECK(trial.state(0).angle == 14.5);
            trial.check();
        }
    }

    TEST_CASE_TEMPLATE("a free spin turns by its rate times the time", Real, float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::impulse;
        Body body = disc(0.5, 2, {});
        body.angular_velocity = 7.25;
        scene.add(body);
        Trial<Real> trial(scene);
        trial.run(600, 1.0 / 64);
        CHECK(trial.state(0).angular_velocity == 7.25);
        CHECK(std::abs(trial.state(0).angle - 7.25 * 600 / 64) <= rounding_of<Real>(600, 70));
        trial.check();
    }
}

}  // namespace test_free_flight

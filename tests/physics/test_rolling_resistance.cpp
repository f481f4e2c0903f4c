// Rolling resistance of solver `soft` (engine/effects/rolling_resistance.hpp), against the equations of a
// disc that rolls without slip. A slope is a level floor under tilted gravity.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace test_rolling_resistance {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kGravity = 9.81, kRadius = 0.5, kStep = 1.0 / 60;

/// A disc on a rough floor that has the rolling resistance, on a slope that falls to the right.
Scene disc_on_slope(double slope, double rolling_resistance, double radius = kRadius) {
    Scene scene;
    scene.gravity = {kGravity * std::sin(slope), -kGravity * std::cos(slope)};
    scene.walls = floor_at(0);
    scene.walls->material.friction = 0.8;
    scene.walls->material.rolling_resistance = rolling_resistance;
    scene.add(disc(radius, 2, {0, radius}));
    scene.bodies[0].material.friction = 0.8;
    return scene;
}

void roll(Scene& scene, double speed, double radius = kRadius) {
    scene.bodies[0].velocity = {speed, 0};
    scene.bodies[0].angular_velocity = -speed / radius;
}

template <class Real>
BodyState after(const Scene& scene, double seconds, double dt = kStep) {
    Trial<Real> trial(scene);
    const double start = trial.world.ledger().energy.total();
    trial.run(static_cast<int>(std::lround(seconds / dt)), dt);
    // In single precision a steady deceleration is rounded the same way in every substep.
    trial.check(4 * start);
    return trial.state(0);
}

/// Speeds and spins that do not change any more.
void check_at_rest(const BodyState& state) {
    CHECK(std::abs(state.velocity.x) < 1e-6);
    CHECK(std::abs(state.velocity.y) < 1e-6);
    CHECK(std::abs(state.angular_velocity) < 1e-6);
}

/// A heavy static disc of radius `base` with a small one on top that turns at `spin`.
template <class Real>
double spin_on_disc(double base, double rolling_resistance, double spin, double seconds) {
    constexpr double kSmall = 0.25;
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add({.type = BodyType::static_body,
               .shape = Disc{base},
               .position = {0, 0},
               .material = {.rolling_resistance = rolling_resistance}});
    scene.add(disc(kSmall, 2, {0, base + kSmall}));  // no friction: nothing but the rolling moment acts
    scene.bodies[1].angular_velocity = spin;
    Trial<Real> trial(scene);
    trial.run(static_cast<int>(std::lround(seconds / kStep)), kStep);
    trial.check();
    return trial.state(1).angular_velocity;
}

}  // namespace

TEST_SUITE("physics/rolling resistance") {
    TEST_CASE_TEMPLATE("a rolling disc slows down at two thirds of c g and stops where that leads", Real,
                       float, double) {
        for (const double c : {0.02, 0.1, 0.3}) {
            for (const double radius : {0.05, 0.5, 3.0}) {
                CAPTURE(c);
                CAPTURE(radius);
                constexpr double kSpeed = 3;
                const double deceleration = 2.0 / 3 * c * kGravity, stops_at = kSpeed / deceleration;
                Scene scene = disc_on_slope(0, c, radius);
                roll(scene, kSpeed, radius);
                const double half = std::round(0.5 * stops_at / kStep) * kStep;
                const BodyState on_the_way = after<Real>(scene, half);
                report("c ", c, " radius ", radius, ": speed off by ",
                       on_the_way.velocity.x - (kSpeed - deceleration * half));
                CHECK(on_the_way.velocity.x == doctest::Approx(kSpeed - deceleration * half).epsilon(2e-4));
                CHECK(on_the_way.angular_velocity ==
                      doctest::Approx(-on_the_way.velocity.x / radius).epsilon(1e-4));
                const BodyState end = after<Real>(scene, stops_at + 0.5);
                const double way = kSpeed * kSpeed / (2 * deceleration);
                report("  way off by ", end.position.x / way - 1);
                CHECK(end.position.x == doctest::Approx(way).epsilon(1e-3));
                check_at_rest(end);
            }
        }
    }

    TEST_CASE_TEMPLATE("a disc stays on a slope below c and rolls down above it", Real, float, double) {
        for (const double c : {0.05, 0.3}) {
            CAPTURE(c);
            const double limit = std::atan(c);
            const BodyState held = after<Real>(disc_on_slope(0.99 * limit, c), 10);
            report("c ", c, ": after 10 s below the limit it is ", held.position.x, " m off");
            CHECK(std::abs(held.position.x) < 1e-4 * kRadius);
            check_at_rest(held);
            const double slope = 1.5 * limit;
            const double a = 2.0 / 3 * kGravity * (std::sin(slope) - c * std::cos(slope));
            const BodyState rolling = after<Real>(disc_on_slope(slope, c), 1);
            CHECK(rolling.velocity.x == doctest::Approx(a).epsilon(2e-3));
            CHECK(rolling.position.x == doctest::Approx(0.5 * a).epsilon(2e-3));
        }
    }

    TEST_CASE_TEMPLATE("a disc that rolls up a slope stops there and does not roll back", Real, float,
                       double) {
        constexpr double kSlope = -0.1, kSpeed = 2, kC = 0.2;
        Scene scene = disc_on_slope(kSlope, kC);
        roll(scene, kSpeed);
        const double deceleration = 2.0 / 3 * kGravity * (std::sin(-kSlope) + kC * std::cos(kSlope));
        const BodyState end = after<Real>(scene, 4);
        CHECK(end.position.x == doctest::Approx(kSpeed * kSpeed / (2 * deceleration)).epsilon(2e-3));
        check_at_rest(end);
    }

    TEST_CASE_TEMPLATE("the moment on another disc has the lever arm c ra rb / (ra + rb)", Real, float,
                       double) {
        constexpr double kSmall = 0.25, kC = 0.1, kSpin = 20, kTime = 0.5;
        for (const double base : {0.25, 1.0, 20.0}) {
            CAPTURE(base);
            const double arm = kC * kSmall * base / (kSmall + base);
            // I alpha = -arm m g with I = m r²/2
            const double expected = kSpin - 2 * arm * kGravity / (kSmall * kSmall) * kTime;
            CHECK(spin_on_disc<Real>(base, kC, kSpin, kTime) == doctest::Approx(expected).epsilon(1e-3));
        }
    }

    TEST_CASE_TEMPLATE("two discs pressed together lose the same moment and end at rest on each other", Real,
                       float, double) {
        Scene scene;
        scene.gravity = {0, -kGravity};
        scene.walls = Walls{.min = {0, 0}, .max = {2.0, 9}};  // two discs, one beside the other, just fit
        for (const double x : {0.4, 1.4}) {
            scene.add(disc(x < 1 ? 0.4 : 0.6, 1, {x, x < 1 ? 0.4 : 0.6}));
            scene.bodies.back().material = {.friction = 0.5, .rolling_resistance = 0.2};
            scene.bodies.back().angular_velocity = x < 1 ? 15 : -4;
        }
        Trial<Real> trial(scene);
        trial.run(600, kStep);
        trial.check();
        for (const std::uint32_t body : {0u, 1u}) check_at_rest(trial.state(body));
        CHECK(trial.all_on.ledger().energy_by_cause.friction < 0);
    }

    TEST_CASE("what was rolled away is in the ledger, under friction, to rounding") {
        Scene scene = disc_on_slope(0, 0.1);
        roll(scene, 3);
        Trial<double> trial(scene);
        trial.run(600, kStep);
        trial.check();
        const Ledger ledger = trial.all_on.ledger();
        const double started = 0.5 * 2 * 3 * 3 * 1.5;  // m v²/2 and half of it again in the spin
        CHECK(ledger.energy_by_cause.friction == doctest::Approx(-started).epsilon(1e-4));
        CHECK(std::abs(ledger.energy_by_cause.unexplained) < 1e-12 * started);
    }
}

}  // namespace test_rolling_resistance

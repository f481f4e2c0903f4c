// Rolling resistance where shapes touch with round parts, against the equations of what rolls without slip. A
// slope is a level floor under tilted gravity.
#include <doctest/doctest.h>

#include <carom/carom.hpp>

#include <cmath>
#include <vector>

namespace test_rolling_shapes {

using namespace carom;

namespace {

constexpr double kGravity = 9.81, kRadius = 0.5, kStep = 1.0 / 60;

/// What rolls on what: a disc on a box, and a wheel of two pieces on a segment.
struct Rolling {
    Shape wheel;
    Body floor;

    /// Mass that rolling moves over mass: 3/2 for a disc.
    double share() const {
        const BodyMass of = body_mass_of({.shape = wheel});
        return 1 + of.inertia / (of.mass * kRadius * kRadius);
    }
    Scene on_slope(double slope, double c) const {
        Scene scene;
        scene.gravity = {kGravity * std::sin(slope), -kGravity * std::cos(slope)};
        scene.add(floor);
        scene.bodies[0].material = {.friction = 0.8, .rolling_resistance = c};
        scene.add({.shape = wheel, .position = {0, kRadius}, .material = {.friction = 0.8}});
        return scene;
    }
};

const std::vector<Rolling> kRolling{
    {Disc{kRadius}, {.type = BodyType::static_body, .shape = Box{400, 1}, .position = {0, -0.5}}},
    {Compound{{{.shape = Disc{kRadius}}, {.shape = Box{0.3, 0.3}}}},
     {.type = BodyType::static_body, .shape = Segment{{-200, 0}, {200, 0}}}},
};

template <class Real>
BodyState after(const Scene& scene, double seconds) {
    BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
    for (int step = 0; step < std::lround(seconds / kStep); ++step) world.step(kStep);
    const Ledger ledger = world.ledger();
    const double scale = std::abs(ledger.initial.total()) + std::abs(ledger.energy_by_cause.gravity);
    CHECK(std::abs(ledger.energy_by_cause.unexplained) < 1e-3 * scale);
    return world.state({1, 0});
}

}  // namespace

TEST_SUITE("physics/rolling resistance of shapes") {
    TEST_CASE_TEMPLATE("what rolls slows down by its moment and stops", Real, float, double) {
        for (const Rolling& rolling : kRolling)
            for (const double c : {0.02, 0.1, 0.3}) {
                CAPTURE(c);
                CAPTURE(rolling.wheel.index());
                constexpr double kSpeed = 3;
                const double deceleration = c * kGravity / rolling.share(), stops_at = kSpeed / deceleration;
                Scene scene = rolling.on_slope(0, c);
                scene.bodies[1].velocity = {kSpeed, 0}, scene.bodies[1].angular_velocity = -kSpeed / kRadius;
                const double half = std::round(0.5 * stops_at / kStep) * kStep;
                const BodyState on_the_way = after<Real>(scene, half);
                CHECK(on_the_way.velocity.x == doctest::Approx(kSpeed - deceleration * half).epsilon(5e-3));
                CHECK(on_the_way.angular_velocity ==
                      doctest::Approx(-on_the_way.velocity.x / kRadius).epsilon(5e-3));
                const BodyState end = after<Real>(scene, stops_at + 0.5);
                CHECK(end.position.x == doctest::Approx(kSpeed * kSpeed / (2 * deceleration)).epsilon(1e-2));
                CHECK(std::abs(end.velocity.x) < 1e-4);
                CHECK(std::abs(end.angular_velocity) < 1e-4);
            }
    }

    TEST_CASE_TEMPLATE("it stays on a slope below c and rolls down above it", Real, float, double) {
        for (const Rolling& rolling : kRolling)
            for (const double c : {0.05, 0.3}) {
                CAPTURE(c);
                CAPTURE(rolling.wheel.index());
                const double limit = std::atan(c);
                const BodyState held = after<Real>(rolling.on_slope(0.99 * limit, c), 8);
                CHECK(std::abs(held.position.x) < 5e-3 * kRadius);
                CHECK(std::abs(held.velocity.x) < 1e-4);
                const double slope = 1.5 * limit;
                const double a = kGravity * (std::sin(slope) - c * std::cos(slope)) / rolling.share();
                const BodyState fell = after<Real>(rolling.on_slope(slope, c), 1);
                CHECK(fell.velocity.x == doctest::Approx(a).epsilon(1e-2));
            }
    }

    TEST_CASE("a sharp corner and a flat side have none: a box tips as it would") {
        const auto angle_of = [](double c) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.add({.type = BodyType::static_body,
                       .shape = Box{10, 1},
                       .position = {0, -0.5},
                       .material = {.friction = 1, .rolling_resistance = c}});
            scene.add({.shape = Box{1, 1}, .position = {0, 0.7}, .angle = 0.6, .material = {.friction = 1}});
            World64 world(scene);
            for (int step = 0; step < 20; ++step) world.step(kStep);
            return world.state({1, 0}).angle;
        };
        CHECK(angle_of(0.5) == doctest::Approx(angle_of(0)).epsilon(1e-9));
    }
}

}  // namespace test_rolling_shapes

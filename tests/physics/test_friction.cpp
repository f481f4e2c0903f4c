// A9, A10, A11, A12 and A13 of docs/exact-cases.md, for discs under solver `soft`: sticking, rolling,
// sliding, and impacts with friction. A slope is a level floor under tilted gravity.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace test_friction {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kGravity = 9.81, kRadius = 0.5, kStep = 1.0 / 60;

/// A disc at rest on a floor, friction `friction`, on a slope of angle `slope` that falls to the right.
Scene disc_on_slope(double slope, double friction) {
    Scene scene;
    scene.gravity = {kGravity * std::sin(slope), -kGravity * std::cos(slope)};
    scene.walls = floor_at(0);
    scene.walls->material.friction = friction;
    scene.add(disc(kRadius, 2, {0, kRadius}));
    scene.bodies[0].material.friction = friction;
    return scene;
}

template <class Real>
BodyState after(const Scene& scene, double seconds) {
    Trial<Real> trial(scene);
    const double start = trial.world.ledger().energy.total();
    trial.run(static_cast<int>(std::lround(seconds / kStep)), kStep);
    trial.check(start);
    return trial.state(0);
}

/// What two discs that touch do: the two velocities and spins after the impact, by the formulas of A13.
struct Impact {
    Vec2 v1, v2;
    double spin1, spin2;
};

Impact exact_impact(const Body& a, const Body& b, Vec2 n, double restitution, double friction) {
    const double ra = std::get<Disc>(a.shape).radius, rb = std::get<Disc>(b.shape).radius;
    const double m = 1 / (1 / *a.mass + 1 / *b.mass);
    const Vec2 t{-n.y, n.x}, v{b.velocity.x - a.velocity.x, b.velocity.y - a.velocity.y};
    const double vn = v.x * n.x + v.y * n.y;
    const double vt = v.x * t.x + v.y * t.y - a.angular_velocity * ra - b.angular_velocity * rb;
    const double jn = -(1 + restitution) * m * vn;
    const double jt = std::clamp(-vt * m / 3, -friction * jn, friction * jn);
    const auto kick = [&](const Body& body, double sign) {
        const double w = sign / *body.mass;
        return Vec2{body.velocity.x + w * (jn * n.x + jt * t.x), body.velocity.y + w * (jn * n.y + jt * t.y)};
    };
    return {kick(a, -1), kick(b, 1), a.angular_velocity - 2 * jt / (*a.mass * ra),
            b.angular_velocity - 2 * jt / (*b.mass * rb)};
}

/// Two rough discs that meet at the origin's right after 0.05 s with their centres along n.
Scene oblique_scene(double angle, double mass, double spin, double restitution, double friction) {
    const Vec2 n{std::cos(angle), std::sin(angle)};
    const Material material{.friction = friction, .restitution = restitution};
    const Vec2 va{3, 0.5}, vb{-1, 0.25};
    const double reach = 0.5 + 0.3, before = 0.05;
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.add({.shape = Disc{0.5},
               .position = {-before * va.x, -before * va.y},
               .velocity = va,
               .angular_velocity = spin,
               .mass = 1,
               .material = material});
    scene.add({.shape = Disc{0.3},
               .position = {reach * n.x - before * vb.x, reach * n.y - before * vb.y},
               .velocity = vb,
               .angular_velocity = -2,
               .mass = mass,
               .material = material});
    return scene;
}

template <class Real>
double worst_oblique_error() {
    double worst = 0;
    for (const double angle : {-0.9, -0.3, 0.0, 0.4, 1.0})
        for (const double mass : {0.01, 1.0, 100.0})
            for (const double spin : {-20.0, 0.0, 5.0})
                for (const double restitution : {0.0, 0.5, 1.0})
                    for (const double friction : {0.0, 0.1, 0.5, 2.0}) {
                        const Scene scene = oblique_scene(angle, mass, spin, restitution, friction);
                        const Impact exact =
                            exact_impact(scene.bodies[0], scene.bodies[1], {std::cos(angle), std::sin(angle)},
                                         restitution, friction);
                        Trial<Real> trial(scene);
                        trial.run(6, kStep);
                        const BodyState a = trial.state(0), b = trial.state(1);
                        for (const double error :
                             {a.velocity.x - exact.v1.x, a.velocity.y - exact.v1.y, b.velocity.x - exact.v2.x,
                              b.velocity.y - exact.v2.y, 0.5 * (a.angular_velocity - exact.spin1),
                              0.3 * (b.angular_velocity - exact.spin2)})
                            worst = std::fmax(worst, std::abs(error));
                        trial.check();
                    }
    return worst;
}

}  // namespace

TEST_SUITE("physics/friction") {
    TEST_CASE_TEMPLATE("a disc rolls down a slope with two thirds of the acceleration", Real, float, double) {
        for (const double slope : {0.1, 0.4, 0.8}) {
            CAPTURE(slope);
            const double way = 0.5 * (2.0 / 3) * kGravity * std::sin(slope) * 4;  // in two seconds
            const BodyState state = after<Real>(disc_on_slope(slope, 1.01 * std::tan(slope) / 3), 2);
            report("slope ", slope, ": way off by ", state.position.x / way - 1);
            CHECK(state.position.x == doctest::Approx(way).epsilon(2e-3));
            CHECK(state.angular_velocity == doctest::Approx(-state.velocity.x / kRadius).epsilon(1e-4));
            CHECK(std::abs(state.position.y - kRadius) < 1e-3 * kRadius);
        }
    }

    TEST_CASE_TEMPLATE("on too little friction it slides and turns as Coulomb says", Real, float, double) {
        for (const double slope : {0.4, 0.8}) {
            const double friction = 0.5 * std::tan(slope) / 3;
            const double a = kGravity * (std::sin(slope) - friction * std::cos(slope));
            const double alpha = 2 * friction * kGravity * std::cos(slope) / kRadius;
            const BodyState state = after<Real>(disc_on_slope(slope, friction), 1);
            report("slope ", slope, ": way off by ", state.position.x / (0.5 * a) - 1, ", spin by ",
                   state.angular_velocity / -alpha - 1);
            CHECK(state.position.x == doctest::Approx(0.5 * a).epsilon(2e-3));
            CHECK(state.angular_velocity == doctest::Approx(-alpha).epsilon(5e-3));
        }
    }

    TEST_CASE_TEMPLATE("a disc launched without spin ends up rolling at two thirds of its speed", Real, float,
                       double) {
        constexpr double kSpeed = 6, kFriction = 0.3;
        Scene scene = disc_on_slope(0, kFriction);
        scene.bodies[0].velocity = {kSpeed, 0};
        const double rolls_at = kSpeed / (3 * kFriction * kGravity);
        const double way = 5 * kSpeed * kSpeed / (18 * kFriction * kGravity);
        const BodyState state = after<Real>(scene, 2);
        CHECK(state.velocity.x == doctest::Approx(2 * kSpeed / 3).epsilon(2e-3));
        CHECK(state.angular_velocity == doctest::Approx(-state.velocity.x / kRadius).epsilon(1e-4));
        CHECK(state.position.x == doctest::Approx(way + (2 - rolls_at) * 2 * kSpeed / 3).epsilon(2e-3));
    }

    TEST_CASE_TEMPLATE("a disc that cannot turn slides to a stop like a box", Real, float, double) {
        constexpr double kSpeed = 4, kFriction = 0.4;
        Scene scene = disc_on_slope(0, kFriction);
        scene.bodies[0].velocity = {kSpeed, 0};
        scene.bodies[0].fixed_rotation = true;
        const BodyState state = after<Real>(scene, 2);
        CHECK(state.position.x ==
              doctest::Approx(kSpeed * kSpeed / (2 * kFriction * kGravity)).epsilon(5e-3));
        CHECK(std::abs(state.velocity.x) < 1e-6);
        CHECK(state.angular_velocity == 0);
    }

    TEST_CASE_TEMPLATE("it sticks on a slope below the angle of friction and slides above it", Real, float,
                       double) {
        constexpr double kFriction = 0.5;
        const auto speed_on = [&](double slope) {
            Scene scene = disc_on_slope(slope, kFriction);
            scene.bodies[0].fixed_rotation = true;
            return after<Real>(scene, 1).velocity.x;
        };
        const double limit = std::atan(kFriction);
        CHECK(std::abs(speed_on(0.99 * limit)) < 1e-5);
        const double steep = 1.01 * limit, a = kGravity * (std::sin(steep) - kFriction * std::cos(steep));
        CHECK(speed_on(steep) == doctest::Approx(a).epsilon(0.02));
    }

    TEST_CASE("rough discs leave an oblique impact as its formulas say, over angles, masses and spins") {
        const double in_double = worst_oblique_error<double>(), in_float = worst_oblique_error<float>();
        report("worst velocity off by ", in_double, " m/s in double, ", in_float, " in float");
        CHECK(in_double < 1e-11);
        CHECK(in_float < 1e-4);
    }
}

}  // namespace test_friction

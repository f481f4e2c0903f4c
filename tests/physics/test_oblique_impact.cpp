// A13 and A14 of docs/exact-cases.md without friction: two discs meet off-centre. Compared with the impulse
// formula, worked out here in long double from the state that the world holds.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace test_oblique_impact {

using namespace carom;
using namespace carom::test;

namespace {

using Number = long double;

struct Case {
    double offset;     // of the line of flight from the other's centre, in sums of radii: sine of the angle
    double direction;  // rad, of the whole set-up
    double mass_ratio;
    double spin;  // rad/s
    double restitution;
};

struct Motion {
    Number vx, vy, spin;
};

constexpr double kStep = 1.0 / 60;

Scene scene_of(const Case& c, Solver solver) {
    constexpr double kRadiusA = 0.5, kRadiusB = 0.3, kReach = kRadiusA + kRadiusB;
    // A flies at 4 m/s along `direction`, B comes the other way at 1 m/s; they touch within the step.
    const Vec2 along{std::cos(c.direction), std::sin(c.direction)}, across{-along.y, along.x};
    const double aside = c.offset * kReach;
    const double ahead = std::sqrt(kReach * kReach - aside * aside) + 0.03;
    const auto at = [&](double x, double y) {
        return Vec2{x * along.x + y * across.x, x * along.y + y * across.y};
    };
    Scene scene;
    scene.accuracy.solver = solver;
    Body a = disc(kRadiusA, 1, {}, at(4, 0), c.restitution);
    Body b = disc(kRadiusB, c.mass_ratio, at(ahead, aside), at(-1, 0.2), c.restitution / 2);
    a.angular_velocity = c.spin, b.angular_velocity = -0.5 * c.spin;
    scene.add(a);
    scene.add(b);
    return scene;
}

struct Pair {
    std::array<Number, 2> x, y, mass, radius;
    std::array<Motion, 2> motion;
    Number restitution;
};

template <class Real>
Pair state_of(const Scene& scene, const BasicWorld<Real>& world) {
    Pair pair{};
    for (std::uint32_t i = 0; i < 2; ++i) {
        const BodyState s = world.state({i, 0});
        pair.x[i] = s.position.x, pair.y[i] = s.position.y;
        pair.motion[i] = {s.velocity.x, s.velocity.y, s.angular_velocity};
        pair.mass[i] = static_cast<Real>(*scene.bodies[i].mass);
        pair.radius[i] = static_cast<Real>(std::get<Disc>(scene.bodies[i].shape).radius);
    }
    pair.restitution = static_cast<Real>(scene.bodies[0].material.restitution);
    return pair;
}

/// After the impact: J = (1 + e) m_eff |vn| along the line of centres at the moment of contact; no friction,
/// so spins stay.
std::array<Motion, 2> after_impact(const Pair& p) {
    const Number x = p.x[1] - p.x[0], y = p.y[1] - p.y[0];
    const Number vx = p.motion[1].vx - p.motion[0].vx, vy = p.motion[1].vy - p.motion[0].vy;
    const Number reach = p.radius[0] + p.radius[1];
    const Number a = vx * vx + vy * vy, b = x * vx + y * vy, c = x * x + y * y - reach * reach;
    const Number t = c / (std::sqrt(b * b - a * c) - b);
    const Number nx = (x + vx * t) / reach, ny = (y + vy * t) / reach;
    const Number approach = vx * nx + vy * ny;
    const Number impulse = -(1 + p.restitution) * approach / (1 / p.mass[0] + 1 / p.mass[1]);
    std::array<Motion, 2> after = p.motion;
    after[0].vx -= impulse / p.mass[0] * nx, after[0].vy -= impulse / p.mass[0] * ny;
    after[1].vx += impulse / p.mass[1] * nx, after[1].vy += impulse / p.mass[1] * ny;
    return after;
}

double largest_difference(const std::array<Motion, 2>& p, const std::array<Motion, 2>& q) {
    Number largest = 0;
    for (std::size_t i = 0; i < 2; ++i)
        for (const Number difference : {p[i].vx - q[i].vx, p[i].vy - q[i].vy, p[i].spin - q[i].spin})
            largest = std::max(largest, std::abs(difference));
    return static_cast<double>(largest);
}

struct Invariants {
    Number px, py, energy, angular_momentum;  // about the given point
};

Invariants invariants_of(const Pair& p, Number about_x, Number about_y) {
    Invariants sum{};
    for (std::size_t i = 0; i < 2; ++i) {
        const Number m = p.mass[i], inertia = m * p.radius[i] * p.radius[i] / 2;
        const Motion& v = p.motion[i];
        sum.px += m * v.vx, sum.py += m * v.vy;
        sum.energy += (m * (v.vx * v.vx + v.vy * v.vy) + inertia * v.spin * v.spin) / 2;
        sum.angular_momentum +=
            m * ((p.x[i] - about_x) * v.vy - (p.y[i] - about_y) * v.vx) + inertia * v.spin;
    }
    return sum;
}

template <class Visit>
void for_each_case(const Visit& visit) {
    for (const Solver solver : {Solver::impulse, Solver::soft})
        for (const double offset : {0.0, 0.1, 0.3, 0.5, -0.5, 0.7, -0.8, 0.9, 0.95})
            for (const double direction : {0.0, 0.4, 1.5707963267948966, 2.5, 4.0, 5.5})
                for (const double mass_ratio : {1e-6, 1e-3, 0.1, 1.0, 3.0, 1e3, 1e6})
                    for (const double spin : {0.0, 12.5})
                        for (const double restitution : {0.0, 0.3, 0.8, 1.0})
                            if (solver == Solver::impulse ||
                                restitution > 0)  // else it is a contact under soft
                                visit(solver, Case{offset, direction, mass_ratio, spin, restitution});
}

}  // namespace

TEST_SUITE("physics/oblique impact") {
    TEST_CASE_TEMPLATE("all six velocities after an oblique impact follow the impulse formula", Real, float,
                       double) {
        constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-12;  // m/s and rad/s, of 12
        double largest = 0;
        for_each_case([&](Solver solver, const Case& c) {
            CAPTURE(name_of(solver));
            const Scene scene = scene_of(c, solver);
            BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
            const std::array<Motion, 2> expected = after_impact(state_of(scene, world));
            world.step(kStep);
            const double difference = largest_difference(state_of(scene, world).motion, expected);
            largest = std::max(largest, difference);
            CAPTURE(c.offset);
            CAPTURE(c.direction);
            CAPTURE(c.mass_ratio);
            CAPTURE(c.restitution);
            const double fastest =
                static_cast<double>(std::max(std::abs(expected[0].vx) + std::abs(expected[0].vy),
                                             std::abs(expected[1].vx) + std::abs(expected[1].vy)));
            REQUIRE(difference <= kTolerance * std::max(1.0, fastest));
            REQUIRE(world.profile().impacts == 1);
            check_books_close(world, c.mass_ratio);
        });
        report("largest difference: ", largest, " m/s");
    }

    TEST_CASE_TEMPLATE(
        "an impact keeps momentum and angular momentum about any point, and takes the energy of "
        "its restitution",
        Real, float, double) {
        // each of the four velocities is rounded once, and the positions
        constexpr double kTolerance = 16 * kRounding<Real>;
        for_each_case([&](Solver solver, const Case& c) {
            CAPTURE(name_of(solver));
            const Scene scene = scene_of(c, solver);
            BasicWorld<Real> world(scene);
            const Pair before = state_of(scene, world);
            const std::array<Motion, 2> expected = after_impact(before);
            world.step(kStep);
            const Pair after = state_of(scene, world);
            const Number mass = before.mass[0] + before.mass[1];
            const double scale = static_cast<double>(mass) * 5;  // kg m/s
            const Number m_eff = before.mass[0] * before.mass[1] / mass;
            for (const double about : {0.0, -3.0, 10.0}) {
                const Invariants a = invariants_of(before, about, 0.5 * about);
                const Invariants b = invariants_of(after, about, 0.5 * about);
                CAPTURE(about);
                CAPTURE(c.mass_ratio);
                REQUIRE(static_cast<double>(std::abs(b.px - a.px)) <= kTolerance * scale);
                REQUIRE(static_cast<double>(std::abs(b.py - a.py)) <= kTolerance * scale);
                REQUIRE(static_cast<double>(std::abs(b.angular_momentum - a.angular_momentum)) <=
                        kTolerance * scale * (1 + std::abs(about)));
            }
            const Number lost = invariants_of(before, 0, 0).energy - invariants_of(after, 0, 0).energy;
            const Number vx = before.motion[1].vx - before.motion[0].vx;
            const Number vy = before.motion[1].vy - before.motion[0].vy;
            const Number wx = expected[1].vx - expected[0].vx, wy = expected[1].vy - expected[0].vy;
            const Number change = std::sqrt((wx - vx) * (wx - vx) + (wy - vy) * (wy - vy));
            const Number vn = change / (1 + before.restitution);
            const Number e = before.restitution;
            REQUIRE(static_cast<double>(std::abs(lost - m_eff * (1 - e * e) * vn * vn / 2)) <=
                    kTolerance * scale * 13);
        });
    }
}

}  // namespace test_oblique_impact

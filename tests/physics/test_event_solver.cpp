// Solver `event` through World and World64: A13, A14, A16, A17, A18, A19 and A21 of docs/exact-cases.md to
// round-off, reversal of time.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

Scene exact(Scene scene) {
    scene.accuracy.solver = Solver::event;
    return scene;
}

using Number = long double;

struct Motion {
    Number x, y, vx, vy, spin;
};

/// Two discs after their impact, from the formulas of Newton and Coulomb.
std::array<Motion, 2> after_impact(std::array<Motion, 2> m, const std::array<Number, 2>& mass,
                                   const std::array<Number, 2>& radius, Number e, Number friction) {
    const Number reach = radius[0] + radius[1], effective = mass[0] * mass[1] / (mass[0] + mass[1]);
    const Number x = m[1].x - m[0].x, y = m[1].y - m[0].y, vx = m[1].vx - m[0].vx, vy = m[1].vy - m[0].vy;
    const Number along = x * vx + y * vy, v2 = vx * vx + vy * vy, gap = x * x + y * y - reach * reach;
    const Number t = gap / (std::sqrt(along * along - v2 * gap) - along);
    const Number nx = (x + vx * t) / reach, ny = (y + vy * t) / reach;
    const Number vn = vx * nx + vy * ny;
    const Number vt = -vx * ny + vy * nx - radius[0] * m[0].spin - radius[1] * m[1].spin;
    const Number jn = -(1 + e) * effective * vn;
    const bool sticks = std::abs(vt) <= 3 * friction * (1 + e) * std::abs(vn);
    const Number jt = sticks ? -vt * effective / 3 : (vt > 0 ? -friction * jn : friction * jn);
    for (std::size_t i = 0; i < 2; ++i) {
        const Number sign = i == 0 ? -1 : 1;
        m[i].vx += sign * (jn * nx - jt * ny) / mass[i];
        m[i].vy += sign * (jn * ny + jt * nx) / mass[i];
        m[i].spin -= 2 * jt / (mass[i] * radius[i]);
    }
    return m;
}

template <class Real>
std::array<Motion, 2> motions(const BasicWorld<Real>& world) {
    std::array<Motion, 2> m;
    for (std::uint32_t i = 0; i < 2; ++i) {
        const BodyState s = world.state({i, 0});
        m[i] = {s.position.x, s.position.y, s.velocity.x, s.velocity.y, s.angular_velocity};
    }
    return m;
}

Number kinetic(const std::array<Motion, 2>& m, const std::array<Number, 2>& mass,
               const std::array<Number, 2>& radius) {
    Number sum = 0;
    for (std::size_t i = 0; i < 2; ++i)
        sum += mass[i] / 2 *
               (m[i].vx * m[i].vx + m[i].vy * m[i].vy + radius[i] * radius[i] / 2 * m[i].spin * m[i].spin);
    return sum;
}

Scene billiard(double ratio) {
    Scene scene;
    scene.walls = Walls{.min = {0, -10},
                        .max = {1e6, 10},
                        .right = false,
                        .bottom = false,
                        .top = false,
                        .material = bouncy(1)};
    scene.add(disc(0.5, 1, {1.5, 0}, {}, 1));
    scene.add(disc(0.5, ratio, {3, 0}, {-1, 0}, 1));
    return exact(scene);
}

}  // namespace

TEST_SUITE("physics/event solver") {
    TEST_CASE_TEMPLATE(
        "A13, A14: six velocities, momentum, angular momentum and energy of rough oblique impacts", Real,
        float, double) {
        constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-12;
        constexpr double kRadiusA = 0.5, kRadiusB = 0.3, kReach = kRadiusA + kRadiusB;
        double largest = 0;
        int sticking = 0, sliding = 0;
        for (const double offset : {0.0, 0.1, -0.3, 0.5, -0.7, 0.9, 0.99})
            for (const double ratio : {1e-3, 0.1, 1.0, 3.0, 1e3})
                for (const double spin : {0.0, 12.5, -30.0})
                    for (const double e : {0.0, 0.5, 1.0})
                        for (const double friction : {0.0, 0.1, 0.5, 5.0}) {
                            Scene scene;
                            const double aside = offset * kReach;
                            const double ahead = std::sqrt(kReach * kReach - aside * aside) + 0.03;
                            Body a = disc(kRadiusA, 1, {}, {4, 0}, e);
                            Body b = disc(kRadiusB, ratio, {ahead, aside}, {-1, 0.2}, e / 2);
                            a.angular_velocity = spin, b.angular_velocity = -0.5 * spin;
                            a.material.friction = b.material.friction = friction;
                            scene.add(a);
                            scene.add(b);
                            BasicWorld<Real> world(exact(scene), {.effects = all_effects()});
                            const std::array<Number, 2> mass{1, static_cast<Real>(ratio)};
                            const std::array<Number, 2> radius{static_cast<Real>(kRadiusA),
                                                               static_cast<Real>(kRadiusB)};
                            const auto before = motions(world);
                            const auto expected = after_impact(before, mass, radius, static_cast<Real>(e),
                                                               static_cast<Real>(friction));
                            world.step(kStep);
                            const auto after = motions(world);
                            CAPTURE(offset);
                            CAPTURE(ratio);
                            CAPTURE(friction);
                            REQUIRE(world.profile().impacts == 1);
                            Number fastest = 1;
                            for (const Motion& m : expected)
                                fastest =
                                    std::max({fastest, std::abs(m.vx), std::abs(m.vy), std::abs(m.spin)});
                            for (std::size_t i = 0; i < 2; ++i)
                                for (const Number difference :
                                     {after[i].vx - expected[i].vx, after[i].vy - expected[i].vy,
                                      after[i].spin - expected[i].spin}) {
                                    largest = std::max(largest,
                                                       static_cast<double>(std::abs(difference) / fastest));
                                    REQUIRE(std::abs(difference) <= kTolerance * fastest);
                                }
                            const Number lost = kinetic(before, mass, radius) - kinetic(after, mass, radius);
                            const EnergyByCause cause = world.ledger().energy_by_cause;
                            const Number scale = 40 * (1 + mass[1]) + kinetic(before, mass, radius);
                            REQUIRE(std::abs(lost + cause.restitution + cause.friction) <=
                                    4 * kTolerance * scale);
                            REQUIRE(cause.restitution <= 0);
                            REQUIRE(cause.friction <= kTolerance);
                            (cause.friction < 0 && friction > 1 ? sticking : sliding) += 1;
                        }
        report("largest relative difference ", largest);
        CHECK(sticking > 100);
        CHECK(sliding > 100);
    }

    TEST_CASE_TEMPLATE(
        "a rough disc bounces off walls as the formula says, and fixed rotation keeps its spin", Real, float,
        double) {
        for (const bool fixed : {false, true})
            for (const double friction : {0.1, 2.0}) {
                Scene scene;
                scene.walls = floor_at(0, 0.5);
                scene.walls->material.friction = friction;
                Body body = disc(0.5, 2, {0, 0.52}, {3, -4}, 0.5);
                body.material.friction = friction, body.fixed_rotation = fixed;
                scene.add(body);
                BasicWorld<Real> world(exact(scene), {.effects = {.ledger = true}});
                world.step(kStep);
                // normal impulse (1 + e) m 4 = 12; slip 3 m/s; it takes m 3 (fixed) or m 3 / 3 to stop that
                const double mu = static_cast<double>(static_cast<Real>(friction));
                const double tangential = std::min(mu * 12, fixed ? 6.0 : 2.0);
                const BodyState state = world.state({0, 0});
                const double tolerance = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
                CHECK(std::abs(state.velocity.x - (3 - tangential / 2)) < tolerance);
                CHECK(std::abs(state.velocity.y - 2) < tolerance);
                CHECK(std::abs(state.angular_velocity - (fixed ? 0 : -tangential / 0.5)) < 4 * tolerance);
                CHECK(std::abs(world.ledger().momentum_by_cause.walls.x + tangential) < 4 * tolerance);
            }
    }

    TEST_CASE("A16: masses 1 and 100^k collide floor(10^k pi) times, k up to 4") {
        const std::array<std::int64_t, 5> expected{3, 31, 314, 3141, 31415};
        double ratio = 1;
        for (const std::int64_t collisions : expected) {
            for (const double dt : {kStep, 5.0}) {
                CAPTURE(ratio);
                World64 world(billiard(ratio));
                for (int i = static_cast<int>(std::lround(60 / dt)); i > 0; --i) world.step(dt);
                CHECK(world.profile().impacts == collisions);
                const double heavy = world.state({1, 0}).velocity.x, light = world.state({0, 0}).velocity.x;
                CHECK(std::abs((light * light + ratio * heavy * heavy) / ratio - 1) < 1e-10);
                CHECK(light <= heavy);
            }
            ratio *= 100;
        }
    }

    TEST_CASE_TEMPLATE("A17, A18: cradle and cannon", Real, float, double) {
        constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
        for (const int moving : {1, 2, 4}) {
            Scene scene;
            double x = 0;
            for (int i = 0; i < 5; ++i) {
                scene.add(disc(0.5, 1, {x, 0}, {i < moving ? 2.0 : 0.0, 0}, 1));
                x += 1.001 + (i + 1 == moving ? 0.3 : 0);
            }
            Trial<Real> trial(exact(scene));
            trial.run(90, kStep);
            for (int i = 0; i < 5; ++i)
                CHECK(std::abs(trial.state(static_cast<std::uint32_t>(i)).velocity.x -
                               (i >= 5 - moving ? 2.0 : 0.0)) <= kTolerance);
            CHECK(trial.world.profile().impacts == moving * (5 - moving));
            trial.check();
        }
        constexpr double kGravity = 9.81, kGap = 0.01;
        for (const double light : {0.01, 0.25}) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.walls = floor_at(0, 1);
            scene.add(disc(0.5, 1, {0, 1.5}, {}, 1));
            scene.add(disc(0.2, light, {0, 2 + kGap + 0.2}, {}, 1));
            Trial<Real> trial(exact(scene));
            trial.run(30, kStep);
            const double v = std::sqrt(2 * kGravity), wait = kGap / (2 * v);
            const double m = static_cast<double>(static_cast<Real>(light));
            const double up = v - kGravity * wait, down = -v - kGravity * wait;
            const double high = ((m - 1) * down + 2 * up) / (1 + m) - kGravity * (0.5 - v / kGravity - wait);
            CHECK(std::abs(trial.state(1).velocity.y - high) <= 10 * kTolerance);
            trial.check(2 * kGravity);
        }
    }

    TEST_CASE("A19: energy within 1e-12 over a million collisions, momentum without walls within 1e-14") {
        const std::int64_t count = 1000, collisions = scaled(1000000, 50000);
        World64 world(exact(gas_scene({.count = count})), {.threads = 1});
        const double start = world.ledger().energy.total();
        while (world.profile().impacts < collisions) world.step(1);
        const double change = world.ledger().energy.total() / start - 1;
        report("relative change of energy ", change, " after ", world.profile().impacts, " collisions");
        CHECK(std::abs(change) < 1e-12);
        CHECK(world.overlaps().max < 1e-12);

        Scene free = gas_scene({.count = 500, .packing_fraction = 0.5});
        free.walls.reset();
        World64 drifting(exact(free), {.threads = 1});
        const Ledger before = drifting.ledger();
        for (int i = 0; i < 120; ++i) drifting.step(kStep);
        const Ledger after = drifting.ledger();
        REQUIRE(drifting.profile().impacts > 1000);
        const double scale = dynamic_mass(free) * 3;
        CHECK(std::abs(after.momentum.x - before.momentum.x) < 1e-14 * scale);
        CHECK(std::abs(after.angular_momentum - before.angular_momentum) < 1e-14 * scale * 20);
    }

    TEST_CASE("friction passes energy of a gas into rotation and takes some; without it nothing turns") {
        Scene scene = gas_scene({.count = 400});
        World64 smooth(exact(scene), {.threads = 1, .effects = {.rotation = true}});
        for (int i = 0; i < 60; ++i) smooth.step(0.1);
        CHECK(smooth.ledger().energy.rotational == 0);
        for (Body& body : scene.bodies) body.material.friction = 0.5;
        World64 rough(exact(scene), {.threads = 1, .effects = {.ledger = true}});
        double energy = rough.ledger().energy.total();
        for (int i = 0; i < 60; ++i) {
            rough.step(0.1);
            const Ledger now = rough.ledger();
            REQUIRE(now.energy.total() < energy);  // friction takes some, always
            energy = now.energy.total();
            REQUIRE(std::abs(now.energy_by_cause.unexplained) < 1e-11 * now.initial.total());
        }
        CHECK(rough.ledger().energy.rotational > 0.05 * energy);
    }

    TEST_CASE("A21: a granular gas cools as exp(-(1 - e^2) tau / 2) to 3 % up to tau = 40") {
        constexpr double e = 0.95;
        const std::int64_t count = 2000;
        Scene scene = gas_scene({.count = count, .packing_fraction = 0.2, .restitution = e});
        scene.walls->material.restitution = 1;
        World64 world(exact(scene), {.threads = 1});
        const double start = world.ledger().energy.kinetic;
        double tau = 0;
        while (tau < scaled(40.0, 10.0)) {
            world.step(0.25);
            const Profile profile = world.profile();
            tau =
                2 * static_cast<double>(profile.impacts - profile.wall_impacts) / static_cast<double>(count);
            const double exact_energy = start * std::exp(-(1 - e * e) * tau / 2);
            CAPTURE(tau);
            REQUIRE(world.ledger().energy.kinetic == doctest::Approx(exact_energy).epsilon(0.03));
        }
        report("energy left ", world.ledger().energy.kinetic / start, " at tau ", tau);
    }

    TEST_CASE("with all velocities reversed a gas returns to where it was after 3 collisions a disc") {
        const std::int64_t count = 1000;
        const Scene scene = exact(gas_scene({.count = count}));
        World64 world(scene, {.threads = 1});
        int steps = 0;
        for (; world.profile().impacts < 3 * count / 2 + count; ++steps)
            world.step(kStep);  // pairs: two discs each
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec2 v = world.state({i, 0}).velocity;
            world.set_velocity({i, 0}, {-v.x, -v.y});
        }
        for (int i = 0; i < steps; ++i) world.step(kStep);
        double largest = 0;
        for (std::uint32_t i = 0; i < count; ++i) {
            const Vec2 x = world.state({i, 0}).position;
            largest = std::max(
                largest, std::hypot(x.x - scene.bodies[i].position.x, x.y - scene.bodies[i].position.y));
        }
        report("farthest from the start ", largest, " m");
        CHECK(largest < 1e-6 * 0.5);
    }

    TEST_CASE_TEMPLATE("every effect on and zero gives the same bits", Real, float, double) {
        Scene scene = gas_scene({.count = 200, .packing_fraction = 0.5, .restitution = 0.9});
        scene.gravity = {0.5, -2};
        Trial<Real> trial(exact(scene));
        trial.run(120, kStep);
        CHECK(trial.world.profile().impacts > 500);
        trial.check();
    }
}

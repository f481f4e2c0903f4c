// A13 and A14 of docs/exact-cases.md with friction, under the solvers that carry out each impact at its own
// time: two discs, walls, discs that do not turn, a disc that spins and that nothing moves, drag. Compared
// with the formulas of Newton and Coulomb, worked out here in long double.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace test_rough_impacts {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr Solver kSolvers[] = {Solver::impulse, Solver::event, Solver::soft};

template <class Real>
constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-12;

using Number = long double;

Scene under(Solver solver, Scene scene) {
    scene.accuracy.solver = solver;
    return scene;
}

struct Motion {
    Number x, y, vx, vy, angle, spin;
};
using Motions = std::array<Motion, 2>;

struct Disc2 {
    Number inverse_mass, radius;
    bool turns = true;
};
using Discs = std::array<Disc2, 2>;

/// Two discs at the end of a step of dt in which they meet once, from the formulas of Newton and Coulomb:
/// along the surface an impulse stops the sliding, which takes 1 / m_t = sum of 1/m + R²/I, or is friction
/// times the normal impulse.
Motions after_step(Motions m, const Discs& d, Number e, Number friction, Number dt) {
    const Number reach = d[0].radius + d[1].radius;
    const Number x = m[1].x - m[0].x, y = m[1].y - m[0].y, vx = m[1].vx - m[0].vx, vy = m[1].vy - m[0].vy;
    const Number along = x * vx + y * vy, v2 = vx * vx + vy * vy, gap = x * x + y * y - reach * reach;
    const Number t = gap / (std::sqrt(along * along - v2 * gap) - along);
    const Number nx = (x + vx * t) / reach, ny = (y + vy * t) / reach;
    const Number vn = vx * nx + vy * ny;
    const Number vt = -vx * ny + vy * nx - d[0].radius * m[0].spin - d[1].radius * m[1].spin;
    Number inverse = 0, inverse_along = 0;
    for (const Disc2& each : d) {
        inverse += each.inverse_mass;
        inverse_along += each.inverse_mass * (each.turns ? 3 : 1);
    }
    const Number jn = -(1 + e) * vn / inverse, most = friction * jn;
    const Number jt = std::clamp(-vt / inverse_along, -most, most);
    for (std::size_t i = 0; i < 2; ++i) {
        m[i].x += m[i].vx * t, m[i].y += m[i].vy * t, m[i].angle += m[i].spin * t;
        const Number w = d[i].inverse_mass, sign = i == 0 ? -1 : 1;
        m[i].vx += sign * (jn * nx - jt * ny) * w;
        m[i].vy += sign * (jn * ny + jt * nx) * w;
        if (d[i].turns) m[i].spin -= 2 * jt * w / d[i].radius;
        m[i].x += m[i].vx * (dt - t), m[i].y += m[i].vy * (dt - t), m[i].angle += m[i].spin * (dt - t);
    }
    return m;
}

template <class Real>
Motions motions(const BasicWorld<Real>& world) {
    Motions m;
    for (std::uint32_t i = 0; i < 2; ++i) {
        const BodyState s = world.state({i, 0});
        m[i] = {s.position.x, s.position.y, s.velocity.x, s.velocity.y, s.angle, s.angular_velocity};
    }
    return m;
}

/// Radii as a world of Real has them.
template <class Real>
Discs discs_of(const Scene& scene) {
    Discs discs;
    for (std::size_t i = 0; i < 2; ++i) {
        const Body& body = scene.bodies[i];
        discs[i].radius = static_cast<Real>(std::get<Disc>(body.shape).radius);
        discs[i].inverse_mass =
            body.type == BodyType::dynamic_body ? 1 / static_cast<Number>(static_cast<Real>(*body.mass)) : 0;
        discs[i].turns = !body.fixed_rotation;
    }
    return discs;
}

Number kinetic(const Motions& m, const Discs& d) {
    Number sum = 0;
    for (std::size_t i = 0; i < 2; ++i)
        if (d[i].inverse_mass > 0)
            sum += (m[i].vx * m[i].vx + m[i].vy * m[i].vy +
                    d[i].radius * d[i].radius / 2 * m[i].spin * m[i].spin) /
                   (2 * d[i].inverse_mass);
    return sum;
}

Number angular_momentum(const Motions& m, const Discs& d) {
    Number sum = 0;
    for (std::size_t i = 0; i < 2; ++i)
        sum += (m[i].x * m[i].vy - m[i].y * m[i].vx + d[i].radius * d[i].radius / 2 * m[i].spin) /
               d[i].inverse_mass;
    return sum;
}

/// Of all that a motion says, over the fastest of speeds and spins.
double largest_difference(const Motions& actual, const Motions& expected) {
    Number fastest = 1, largest = 0;
    for (std::size_t i = 0; i < 2; ++i) {
        const Motion &a = actual[i], &e = expected[i];
        fastest = std::max({fastest, std::abs(e.vx), std::abs(e.vy), std::abs(e.spin)});
        for (const Number difference :
             {a.vx - e.vx, a.vy - e.vy, a.spin - e.spin, a.x - e.x, a.y - e.y, a.angle - e.angle})
            largest = std::max(largest, std::abs(difference));
    }
    return static_cast<double>(largest / fastest);
}

/// Two discs that meet off-centre within a step, `offset` sums of radii aside.
Scene oblique(double offset, double ratio, double spin, double e, double friction) {
    constexpr double kRadiusA = 0.5, kRadiusB = 0.3, kReach = kRadiusA + kRadiusB;
    const double aside = offset * kReach;
    const double ahead = std::sqrt(kReach * kReach - aside * aside) + 0.03;
    Scene scene;
    Body a = disc(kRadiusA, 1, {}, {4, 0}, e);
    Body b = disc(kRadiusB, ratio, {ahead, aside}, {-1, 0.2}, e / 2);
    a.angular_velocity = spin, b.angular_velocity = -0.5 * spin;
    a.material.friction = b.material.friction = friction;
    scene.add(a);
    scene.add(b);
    return scene;
}

}  // namespace

TEST_SUITE("physics/rough impacts") {
    TEST_CASE_TEMPLATE(
        "A13, A14: six velocities, momentum, angular momentum and energy of rough oblique impacts", Real,
        float, double) {
        double largest = 0;
        int with_friction = 0, sliding = 0;
        for (const Solver solver : kSolvers)
            for (const double offset : {0.0, 0.1, -0.3, 0.5, -0.7, 0.9, 0.99})
                for (const double ratio : {1e-3, 0.1, 1.0, 3.0, 1e3})
                    for (const double spin : {0.0, 12.5, -30.0})
                        for (const double e : {0.0, 0.5, 1.0})
                            for (const double friction : {0.0, 0.1, 0.5, 5.0}) {
                                if (solver == Solver::soft && e == 0) continue;  // a contact, not an impact
                                const Scene scene = under(solver, oblique(offset, ratio, spin, e, friction));
                                BasicWorld<Real> world(scene, {.effects = all_effects()});
                                const Discs discs = discs_of<Real>(scene);
                                const Motions before = motions(world);
                                const Motions expected = after_step(before, discs, static_cast<Real>(e),
                                                                    static_cast<Real>(friction), kStep);
                                world.step(kStep);
                                const Motions after = motions(world);
                                CAPTURE(name_of(solver));
                                CAPTURE(offset);
                                CAPTURE(ratio);
                                CAPTURE(spin);
                                CAPTURE(friction);
                                REQUIRE(world.profile().impacts == 1);
                                const double difference = largest_difference(after, expected);
                                largest = std::max(largest, difference);
                                REQUIRE(difference <= kTolerance<Real>);
                                const Number lost = kinetic(before, discs) - kinetic(after, discs);
                                const EnergyByCause cause = world.ledger().energy_by_cause;
                                const Number scale = 40 * (1 + ratio) + kinetic(before, discs);
                                REQUIRE(std::abs(lost + cause.restitution + cause.friction) <=
                                        4 * kTolerance<Real> * scale);
                                REQUIRE(cause.restitution <= kTolerance<Real>);
                                REQUIRE(cause.friction <= kTolerance<Real>);
                                REQUIRE(std::abs(angular_momentum(after, discs) -
                                                 angular_momentum(before, discs)) <=
                                        kTolerance<Real> * scale);
                                check_books_close(world, static_cast<double>(scale), 1 + ratio);
                                with_friction += cause.friction < 0;
                                sliding += cause.friction < 0 && friction == 0.1;
                            }
        report("largest relative difference ", largest);
        CHECK(sliding > 100);
        CHECK(with_friction - sliding > 100);
    }

    TEST_CASE_TEMPLATE("of two discs one or both of which do not turn, too", Real, float, double) {
        for (const Solver solver : kSolvers)
            for (const int fixed : {1, 2, 3})
                for (const double friction : {0.1, 5.0}) {
                    Scene scene = under(solver, oblique(0.5, 3, 12.5, 0.8, friction));
                    for (const int i : {0, 1})
                        if (((fixed >> i) & 1) != 0) {
                            Body& body = scene.bodies[static_cast<std::size_t>(i)];
                            body.fixed_rotation = true, body.angular_velocity = 0, body.angle = 0.5;
                        }
                    BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
                    const Motions expected =
                        after_step(motions(world), discs_of<Real>(scene), static_cast<Real>(0.8),
                                   static_cast<Real>(friction), kStep);
                    world.step(kStep);
                    CAPTURE(name_of(solver));
                    CAPTURE(fixed);
                    CHECK(largest_difference(motions(world), expected) <= kTolerance<Real>);
                    check_books_close(world, 4);
                }
    }

    TEST_CASE_TEMPLATE("a kinematic disc that moves and spins drives what it meets, and the books say so",
                       Real, float, double) {
        for (const Solver solver : kSolvers)
            for (const bool kinematic_first : {false, true})
                for (const double friction : {0.1, 5.0})
                    for (const double spin : {-20.0, 0.0, 7.0}) {
                        Scene scene = under(solver, oblique(0.3, 2, spin, 0.5, friction));
                        Body& driver = scene.bodies[kinematic_first ? 0 : 1];
                        driver.type = BodyType::kinematic_body, driver.mass.reset();
                        driver.angle = 0.25;
                        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
                        const Discs discs = discs_of<Real>(scene);
                        const Motions before = motions(world);
                        const Motions expected = after_step(before, discs, static_cast<Real>(0.5),
                                                            static_cast<Real>(friction), kStep);
                        world.step(kStep);
                        CAPTURE(name_of(solver));
                        CAPTURE(kinematic_first);
                        CAPTURE(friction);
                        CAPTURE(spin);
                        CHECK(largest_difference(motions(world), expected) <= kTolerance<Real>);
                        check_books_close(world, 2);
                    }
    }

    TEST_CASE_TEMPLATE(
        "a rough disc bounces off walls as the formula says, and fixed rotation keeps its spin", Real, float,
        double) {
        constexpr double kTight = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
        for (const Solver solver : kSolvers)
            for (const bool fixed : {false, true})
                for (const double spin : {0.0, 9.0, -40.0})
                    for (const double friction : {0.1, 2.0}) {
                        if (fixed && spin != 0) continue;
                        Scene scene = under(solver, {});
                        scene.walls = floor_at(0, 0.5);
                        scene.walls->material.friction = friction;
                        Body body = disc(0.5, 2, {0, 0.52}, {3, -4}, 0.5);
                        body.material.friction = friction, body.fixed_rotation = fixed;
                        body.angular_velocity = spin;
                        scene.add(body);
                        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
                        world.step(kStep);
                        // Normal impulse (1 + e) m 4 = 12; the surface slides at 3 + R spin m/s, and stopping
                        // it takes m times that if the disc cannot turn, else a third.
                        const double mu = static_cast<double>(static_cast<Real>(friction));
                        const double slip = 3 + 0.5 * spin, stop = 2 * slip / (fixed ? 1 : 3);
                        const double along = std::clamp(stop, -mu * 12, mu * 12);
                        const BodyState state = world.state({0, 0});
                        const double after = spin - (fixed ? 0 : along / 0.5);
                        CAPTURE(name_of(solver));
                        CAPTURE(spin);
                        CHECK(std::abs(state.velocity.x - (3 - along / 2)) < kTight);
                        CHECK(std::abs(state.velocity.y - 2) < kTight);
                        CHECK(std::abs(state.angular_velocity - after) < 4 * kTight);
                        const double turned = spin * 0.005 + after * (kStep - 0.005);
                        CHECK(std::abs(state.angle - turned) < 4 * kTight);
                        CHECK(std::abs(world.ledger().momentum_by_cause.walls.x + along) < 4 * kTight);
                        check_books_close(world, 2);
                    }
    }

    TEST_CASE_TEMPLATE("drag slows flight and spin before and after a rough impact, each for its time", Real,
                       float, double) {
        constexpr double kTight = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
        constexpr double kLinear = 3, kAngular = 5, kSpin = 8, kFriction = 0.125, kWay = 0.0625;
        for (const double linear : {0.0, kLinear}) {
            Scene scene = under(Solver::impulse, {});
            scene.drag = {.linear = linear, .angular = kAngular};
            scene.walls = floor_at(0, 0.5);
            scene.walls->material.friction = kFriction;
            Body body = disc(0.5, 2, {0, 0.5 + kWay}, {3, -4}, 0.5);
            body.material.friction = kFriction, body.angular_velocity = kSpin;
            scene.add(body);
            BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
            constexpr double kLong = 1.0 / 32;
            world.step(kLong);
            // way = v (1 - exp(-k t)) / k
            const double t = linear > 0 ? -std::log(1 - linear * kWay / 4) / linear : kWay / 4;
            const double slowed = std::exp(-linear * t), spin_slowed = std::exp(-kAngular * t);
            const double normal = 2 * 1.5 * 4 * slowed;
            const double along = kFriction * normal;  // it slides: 3 + 4 m/s would take 4.7 of 1.5 N s
            const double rest = kLong - t, decay = std::exp(-kAngular * rest);
            const double turning = kSpin * spin_slowed - along / 0.5;
            const BodyState state = world.state({0, 0});
            CAPTURE(linear);
            CHECK(world.profile().impacts == 1);
            CHECK(std::abs(state.velocity.x - (3 * slowed - along / 2) * std::exp(-linear * rest)) < kTight);
            CHECK(std::abs(state.angular_velocity - turning * decay) < kTight);
            const double turned = (kSpin * (1 - spin_slowed) + turning * (1 - decay)) / kAngular;
            CHECK(std::abs(state.angle - turned) < kTight);
            check_books_close(world, 2);
        }
    }

    TEST_CASE_TEMPLATE("drag slows no kinematic body: it turns by its spin times the time", Real, float,
                       double) {
        Scene scene = under(Solver::impulse, {});
        scene.drag = {.angular = 4};
        scene.add({.type = BodyType::kinematic_body, .shape = Disc{0.5}, .angular_velocity = 2});
        scene.add(disc(0.5, 1, {4, 0}, {1, 0}));
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 64; ++i) world.step(1.0 / 64);
        CHECK(world.state({0, 0}).angular_velocity == 2);
        CHECK(std::abs(world.state({0, 0}).angle - 2) < 64 * kTolerance<Real>);
    }

    TEST_CASE_TEMPLATE("impacts at one instant rub as under event, whatever turns, and the books close", Real,
                       float, double) {
        constexpr double kTight = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
        const double side = std::sqrt(0.75);
        for (const double friction : {0.05, 0.25})
            for (const double spin : {0.0, 6.0}) {
                Scene scene;
                // A spinning disc breaks a pair, one of which does not turn; another flies into a corner.
                scene.walls = Walls{.min = {-10, -10}, .max = {30, 10}, .material = bouncy(0.9)};
                scene.walls->material.friction = friction;
                scene.add(disc(0.5, 1, {-0.0625, 0}, {8, 0}, 0.9));
                scene.add(disc(0.5, 2, {side, 0.5}, {}, 0.9));
                scene.add(disc(0.5, 2, {side, -0.5}, {}, 0.9));
                scene.add(disc(0.5, 1, {-9.4375, -9.4375}, {-8, -8}, 0.9));
                for (Body& body : scene.bodies) body.material.friction = friction;
                scene.bodies[0].angular_velocity = spin, scene.bodies[3].angular_velocity = -spin;
                scene.bodies[2].fixed_rotation = true;
                BasicWorld<Real> impulse(under(Solver::impulse, scene), {.effects = {.ledger = true}});
                BasicWorld<Real> event(under(Solver::event, scene), {.effects = {.ledger = true}});
                impulse.step(kStep), event.step(kStep);
                CAPTURE(friction);
                CAPTURE(spin);
                CHECK(impulse.profile().simultaneous_impacts == 4);
                CHECK(impulse.profile().impacts == event.profile().impacts);
                for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
                    const BodyState a = impulse.state({i, 0}), b = event.state({i, 0});
                    CAPTURE(i);
                    CHECK(std::hypot(a.velocity.x - b.velocity.x, a.velocity.y - b.velocity.y) < 8 * kTight);
                    CHECK(std::hypot(a.position.x - b.position.x, a.position.y - b.position.y) < 8 * kTight);
                    CHECK(std::abs(a.angular_velocity - b.angular_velocity) < 16 * kTight);
                    CHECK(std::abs(a.angle - b.angle) < 8 * kTight);
                }
                check_books_close(impulse, 7);
                CHECK(impulse.ledger().energy_by_cause.friction ==
                      doctest::Approx(event.ledger().energy_by_cause.friction).epsilon(1e3 * kTight));
            }
    }
}

}  // namespace test_rough_impacts

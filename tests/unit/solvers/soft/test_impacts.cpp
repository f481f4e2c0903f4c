// One impact within a step of solver `soft` under gravity: a disc and another one, which falls too, stands,
// or moves and spins and is moved by nothing; a wall; a segment. Compared with the parabolas before and after
// the impact and with the laws of Newton and Coulomb, worked out here in long double; the time of the impact
// is found by bisection. Without gravity tests/physics/test_rough_impacts.cpp has the same.
#include "math/vec2_math.hpp"
#include "support/books.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <optional>
#include <utility>

namespace test_impacts {

using namespace carom;
using namespace carom::test;

namespace {

using Number = long double;
constexpr double kStep = 1.0 / 60;  // s
constexpr double kRadius = 0.5;     // m, of the disc that hits

/// What of the motion a step may have wrong [m, m/s, rad, rad/s], for speeds and spins of up to 12.
template <class Real>
constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;

enum class Obstacle { disc, still_disc, driven_disc, wall, segment };

struct Hit {
    Obstacle obstacle;
    Vec2 gravity;   // m/s²
    double angle;   // rad, from the disc to what it hits
    double offset;  // of what is round, in sums of radii
    double friction;
    double spin;   // rad/s
    double ratio;  // of masses
    bool fixed;    // whether the disc does not turn
};

struct Path {
    Number x, y, vx, vy, ax, ay;  // m, m/s, m/s²
    Number angle, spin;           // rad, rad/s
    Number inverse_mass, radius;  // 1/kg, m
    bool turns;

    void fly(Number t) {
        x += vx * t + ax * t * t / 2, y += vy * t + ay * t * t / 2;
        vx += ax * t, vy += ay * t, angle += spin * t;
    }
};

/// A line through a point that nothing moves; the normal points from the disc to it.
struct Line {
    Number x, y, nx, ny;
};

struct Way {
    Number width, nx, ny;
};

Way way_to(const Path& a, const Path& b) {
    const Number x = b.x - a.x, y = b.y - a.y, distance = std::sqrt(x * x + y * y);
    return {distance - a.radius - b.radius, x / distance, y / distance};
}

Way way_to(const Path& a, const Line& line) {
    return {(line.x - a.x) * line.nx + (line.y - a.y) * line.ny - a.radius, line.nx, line.ny};
}

/// When the width between two that fly is 0 for the first time [s].
template <class Other>
Number time_of_impact(const Path& a, const Other& other, Number dt) {
    const auto width_at = [&](Number t) {
        Path p = a;
        p.fly(t);
        Other q = other;
        if constexpr (std::is_same_v<Other, Path>) q.fly(t);
        return way_to(p, q).width;
    };
    constexpr int kPieces = 512;
    Number low = 0, high = 0;
    for (int i = 1; i <= kPieces && width_at(high) > 0; ++i) low = high, high = dt * i / kPieces;
    REQUIRE(width_at(0) > 0);
    REQUIRE(width_at(high) <= 0);
    for (int i = 0; i < 80; ++i) {
        const Number middle = (low + high) / 2;
        (width_at(middle) > 0 ? low : high) = middle;
    }
    return low;
}

struct Losses {
    Number restitution, friction;  // J, never positive unless something drives
};

/// Carries out the impact of bodies that touch. @param b  of infinite mass if it is a line
Losses collide(Path& a, Path& b, Number nx, Number ny, Number e, Number friction) {
    const auto along = [&] {
        return -(b.vx - a.vx) * ny + (b.vy - a.vy) * nx - a.radius * a.spin - b.radius * b.spin;
    };
    const Number vn = (b.vx - a.vx) * nx + (b.vy - a.vy) * ny, vt = along();
    const Number inverse = a.inverse_mass + b.inverse_mass;
    const Number inverse_along = a.inverse_mass * (a.turns ? 3 : 1) + b.inverse_mass * (b.turns ? 3 : 1);
    const Number jn = -(1 + e) * vn / inverse, most = friction * jn;
    const Number jt = std::clamp(-vt / inverse_along, -most, most);
    for (Path* p : {&a, &b}) {
        const Number j = (p == &a ? -1 : 1) * p->inverse_mass;
        p->vx += j * (jn * nx - jt * ny), p->vy += j * (jn * ny + jt * nx);
        if (p->turns && p->inverse_mass > 0) p->spin -= 2 * jt * p->inverse_mass / p->radius;
    }
    return {-(1 - e * e) * vn * vn / inverse / 2, jt * (vt + along()) / 2};
}

Scene scene_of(const Hit& hit) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = hit.gravity;
    const Vec2 n{std::cos(hit.angle), std::sin(hit.angle)}, t{-n.y, n.x};
    Body a = disc(kRadius, 1, {3, -2}, 4.0 * n + 1.5 * t, 0.75);
    a.material.friction = hit.friction, a.fixed_rotation = hit.fixed;
    a.angle = 0.25, a.angular_velocity = hit.fixed ? 0 : hit.spin;
    scene.add(a);
    constexpr double kGap = 0.02;
    if (hit.obstacle == Obstacle::wall) {  // the floor, whatever the angle
        scene.bodies[0].velocity = {1.5, -4};
        scene.walls = floor_at(a.position.y - kRadius - kGap, 0);
        scene.walls->material.friction = hit.friction;
    } else if (hit.obstacle == Obstacle::segment) {
        const Vec2 middle = a.position + (kRadius + kGap) * n;
        scene.add({.type = BodyType::static_body,
                   .shape = Segment{middle - 4.0 * t, middle + 5.0 * t},
                   .material = {.friction = hit.friction}});
    } else {
        constexpr double kOther = 0.3;
        const double reach = kRadius + kOther, aside = hit.offset * reach,
                     ahead = std::sqrt(reach * reach - aside * aside) + kGap;
        Body b = disc(kOther, hit.ratio, a.position + ahead * n + aside * t, -1.0 * n + 0.25 * t, 0.5);
        b.material.friction = hit.friction, b.angular_velocity = -0.5 * hit.spin;
        if (hit.obstacle != Obstacle::disc) b.mass.reset();
        if (hit.obstacle == Obstacle::driven_disc) b.type = BodyType::kinematic_body;
        if (hit.obstacle == Obstacle::still_disc)
            b.type = BodyType::static_body, b.velocity = {}, b.angular_velocity = 0;
        scene.add(b);
    }
    return scene;
}

template <class Real>
Path path_of(const BasicWorld<Real>& world, const Scene& scene, std::uint32_t i) {
    const BodyState s = world.state({i, 0});
    const Body& body = scene.bodies[i];
    const bool falls = body.type == BodyType::dynamic_body;
    const auto gravity = [&](double g) { return falls ? static_cast<Number>(static_cast<Real>(g)) : 0; };
    return {s.position.x,
            s.position.y,
            s.velocity.x,
            s.velocity.y,
            gravity(scene.gravity.x),
            gravity(scene.gravity.y),
            s.angle,
            s.angular_velocity,
            falls ? 1 / static_cast<Number>(static_cast<Real>(*body.mass)) : 0,
            static_cast<Real>(std::get<Disc>(body.shape).radius),
            !body.fixed_rotation};
}

double difference(const Path& p, const Path& q) {
    Number largest = 0;
    for (const Number each :
         {p.x - q.x, p.y - q.y, p.vx - q.vx, p.vy - q.vy, p.angle - q.angle, p.spin - q.spin})
        largest = std::max(largest, std::abs(each));
    return static_cast<double>(largest);
}

/// Steps the scene once and compares. @return the largest difference
template <class Real>
double check_hit(const Hit& hit) {
    const Scene scene = scene_of(hit);
    BasicWorld<Real> world(scene, {.threads = 1, .effects = {.ledger = true}});
    const bool is_round = hit.obstacle <= Obstacle::driven_disc;
    Path a = path_of(world, scene, 0), b{};
    const Number friction = static_cast<Real>(hit.friction), e = 0.75;
    Losses losses{};
    const auto meet = [&](const auto& other) {
        const Number t = time_of_impact(a, other, kStep);
        a.fly(t), b.fly(t);
        Way way{};
        if constexpr (std::is_same_v<std::decay_t<decltype(other)>, Line>)
            way = way_to(a, other);
        else
            way = way_to(a, b);
        losses = collide(a, b, way.nx, way.ny, e, friction);
        a.fly(kStep - t), b.fly(kStep - t);
    };
    if (is_round) {
        b = path_of(world, scene, 1);
        meet(b);
    } else if (hit.obstacle == Obstacle::wall) {
        meet(Line{0, static_cast<Real>(scene.walls->min.y), 0, -1});
    } else {
        const auto& ends = std::get<Segment>(scene.bodies[1].shape);
        const Number x = static_cast<Number>(ends.b.x) - ends.a.x,
                     y = static_cast<Number>(ends.b.y) - ends.a.y, length = std::sqrt(x * x + y * y);
        meet(Line{ends.a.x, ends.a.y, y / length, -x / length});
    }
    world.step(kStep);
    CHECK(world.profile().impacts == 1);
    double largest = difference(path_of(world, scene, 0), a);
    if (is_round) largest = std::max(largest, difference(path_of(world, scene, 1), b));
    CHECK(largest <= kTolerance<Real>);
    const EnergyByCause by = world.ledger().energy_by_cause;
    const double scale = 100 * (1 + hit.ratio);
    CHECK(std::abs(by.restitution - static_cast<double>(losses.restitution)) <= kTolerance<Real> * scale);
    CHECK(std::abs(by.friction - static_cast<double>(losses.friction)) <= kTolerance<Real> * scale);
    check_books_close(world, scale, 1 + hit.ratio);
    return largest;
}

}  // namespace

TEST_SUITE("solvers/soft/impacts") {
    TEST_CASE_TEMPLATE(
        "A13: paths broken by an impact are exact under gravity, whatever is hit, with friction and spin",
        Real, float, double) {
        for (const Obstacle obstacle : {Obstacle::disc, Obstacle::still_disc, Obstacle::driven_disc,
                                        Obstacle::wall, Obstacle::segment}) {
            double largest = 0;
            const bool is_round = obstacle <= Obstacle::driven_disc;
            for (const Vec2 gravity : {Vec2{}, Vec2{0, -9.81}, Vec2{3, -20}})
                for (const double angle : scaled<std::vector<double>>({0, 1.1, 2.5, 4.5}, {1.1, 4.5}))
                    for (const double offset : {0.0, 0.5, -0.8})
                        for (const double friction : {0.0, 0.2, 5.0})
                            for (const double spin : {0.0, 12.0, -7.0})
                                for (const double ratio : {1.0, 1e-2, 30.0})
                                    for (const bool fixed : {false, true}) {
                                        if (!is_round && offset != 0) continue;
                                        if (obstacle != Obstacle::disc && ratio != 1) continue;
                                        CAPTURE(static_cast<int>(obstacle));
                                        CAPTURE(gravity.y);
                                        CAPTURE(angle);
                                        CAPTURE(offset);
                                        CAPTURE(friction);
                                        CAPTURE(spin);
                                        CAPTURE(ratio);
                                        CAPTURE(fixed);
                                        largest = std::max(largest,
                                                           check_hit<Real>({obstacle, gravity, angle, offset,
                                                                            friction, spin, ratio, fixed}));
                                    }
            report("obstacle ", static_cast<int>(obstacle), ": largest difference ", largest);
        }
    }
}

}  // namespace test_impacts

#include "solvers/manifolds/finders/distant_pairs.hpp"

#include "isa/select_isa.hpp"
#include "support/convex_oracle.hpp"
#include "support/convex_pairs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

namespace test_distant_pairs {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s
constexpr ContactDistance kNear{.share = 0.1, .fall = 3e-3};

/// Planks, boxes, capsules, discs, triangles and one compound, some of them static, crowded in a square.
template <class Real>
WorldState<Real> crowd(Draw& draw, std::size_t count) {
    WorldState<Real> world;
    world.bodies.has_rotation = world.bodies.has_shapes = true;
    const auto shape = [&](std::size_t i) -> Shape {
        switch (i % 6) {
            case 0:
                return Box{2, 0.02};
            case 1:
                return Box{draw(0.1, 1), draw(0.1, 1)};
            case 2:
                return Capsule{draw(0.2, 3), draw(0.02, 0.2)};
            case 3:
                return Disc{draw(0.05, 0.5)};
            case 4:
                return Polygon{.vertices = {{0, 0}, {draw(0.5, 2), 0}, {0, draw(0.2, 1)}}, .radius = 0.01};
            default:
                return Box{0.02, 2};
        }
    };
    for (std::size_t i = 0; i < count; ++i)
        world.append({.type = i % 7 == 6 ? BodyType::static_body : BodyType::dynamic_body,
                      .shape = shape(i),
                      .position = {draw(-4, 4), draw(-4, 4)},
                      .angle = draw(-3, 3),
                      .material = {.restitution = i % 4 == 3 ? 0.8 : 0}});
    world.append({.shape = Compound{{{Box{0.2, 1}, {1, 0}, 0}, {Disc{0.3}, {-1, 0}, 0}}}});
    return world;
}

/// What a step does to bodies: most fly as their velocity says, some are pushed farther by others.
template <class Real>
void move(WorldState<Real>& world, Draw& draw) {
    Bodies<Real>& bodies = world.bodies;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.is_immovable(row)) continue;
        const double farther = draw.below(10) == 0 ? 3 : 1;
        const auto dt = static_cast<Real>(kStep * farther);
        bodies.position_x[row] += dt * bodies.velocity_x[row];
        bodies.position_y[row] += dt * bodies.velocity_y[row];
        bodies.angle[row] += dt * bodies.angular_velocity[row];
        const auto speed = [&](double most) { return static_cast<Real>(draw(-most, most)); };
        bodies.velocity_x[row] = speed(2), bodies.velocity_y[row] = speed(2);
        bodies.angular_velocity[row] = speed(1);
    }
}

/// The smallest distance of two bodies in a step, whether each of them flies on, is stopped, or flies back
/// with the restitution of the pair; all turn on [m].
template <class Real>
double least_distance(const WorldState<Real>& world, std::size_t a, std::size_t b) {
    const Bodies<Real>& bodies = world.bodies;
    const double e = std::max<double>(bodies.restitution[a], bodies.restitution[b]);
    const auto placed = [&](std::size_t row, double share, double time) {
        const Real angle = bodies.angle[row] + static_cast<Real>(time) * bodies.angular_velocity[row];
        const auto moved = static_cast<Real>(share * time);
        const Real pose[] = {bodies.position_x[row] + moved * bodies.velocity_x[row],
                             bodies.position_y[row] + moved * bodies.velocity_y[row], std::cos(angle),
                             std::sin(angle)};
        return place(world.shapes[bodies.shape[row]], pose);
    };
    double least = 1e30;
    for (const double of_a : {1.0, 0.0, -e})
        for (const double of_b : {1.0, 0.0, -e})
            for (const double time : {0.0, kStep / 3, 2 * kStep / 3, kStep})
                least = std::min(least, signed_distance(placed(a, of_a, time), placed(b, of_b, time)));
    return least;
}

}  // namespace

TEST_SUITE("solvers/manifolds/distant_pairs") {
    TEST_CASE_TEMPLATE("no pair waits that can touch, and most pairs of a loose crowd wait", Real, float,
                       double) {
        Draw draw(5);
        WorldState<Real> world = crowd<Real>(draw, 60);
        const Bodies<Real>& bodies = world.bodies;
        DistantPairs<Real> distant;
        PoseWatch<Real> poses;
        std::set<std::pair<std::int32_t, std::int32_t>> waiting;
        const std::size_t compound = bodies.count - 1;
        const auto list = [&] {
            waiting.clear(), distant.clear(), poses.begin_paths();
            for (std::size_t a = 0; a < bodies.count; ++a)
                for (std::size_t b = a + 1; b < bodies.count; ++b) {
                    const std::size_t first = bodies.is_immovable(a) ? b : a, second = a + b - first;
                    if (bodies.is_immovable(first)) continue;
                    const std::pair pair{static_cast<std::int32_t>(first), static_cast<std::int32_t>(second)};
                    distant.add(pair.first, pair.second), waiting.insert(pair);
                }
        };
        const Executor executor(1);
        const ConvexKernels<Real>& kernels = *select_kernels("auto").of<Real>().convex;
        const auto speed = [&](std::size_t row) {  // of the surface, in both directions [m/s]
            return static_cast<double>(std::fabs(bodies.velocity_x[row]) + std::fabs(bodies.velocity_y[row]) +
                                       std::fabs(bodies.angular_velocity[row]) * bodies.radius[row]);
        };
        std::size_t listed = 0, left_after_ten = 0, parted_by_direction = 0;
        for (int step = 0; step < 120; ++step) {
            if (step % 40 == 0) list(), listed += waiting.size();
            poses.look(world, kStep, kNear, false, kernels, executor);
            for (const auto& pair : distant.take_near(world, kStep, true, poses, kNear, kernels, executor))
                REQUIRE(waiting.erase({pair.a, pair.b}) == 1);
            for (const auto& [first, second] : waiting) {
                const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
                REQUIRE(a != compound);  // its pieces are anywhere in its circle
                REQUIRE(b != compound);
                const auto placed = [&](std::size_t row) {
                    const Real pose[] = {bodies.position_x[row], bodies.position_y[row],
                                         std::cos(bodies.angle[row]), std::sin(bodies.angle[row])};
                    return place(world.shapes[bodies.shape[row]], pose);
                };
                const double reach = kNear(pair_thickness(bodies, a, b)),
                             ways = kStep * (speed(a) + speed(b));
                if (signed_distance(placed(a), placed(b)) > reach + ways) continue;
                CAPTURE(step);
                CAPTURE(a);
                CAPTURE(b);
                ++parted_by_direction;
                REQUIRE(least_distance(world, a, b) > reach - 1e-5);
            }
            if (step % 40 == 9) left_after_ten += waiting.size();
            move(world, draw);
        }
        CHECK(left_after_ten > listed / 2);
        CHECK(parted_by_direction > 100);
    }
}

}  // namespace test_distant_pairs

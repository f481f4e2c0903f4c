// Pairs of slim bodies: few are listed, and none is missed that meets, whatever the bodies do.
#include "broadphase/slim_bodies.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "broadphase/candidates.hpp"
#include "isa/select_isa.hpp"
#include "math/vec2_math.hpp"
#include "state/world_state.hpp"
#include "support/convex_oracle.hpp"
#include "support/convex_pairs.hpp"
#include "support/effort.hpp"

namespace test_slim_bodies {

using namespace carom;
using namespace carom::test;

namespace {

constexpr std::size_t kCount = 160;
constexpr double kStep = 1.0 / 60, kSide = 16;  // s, m

/// Planks, and some boxes and discs, that fly and turn; now and then one is kicked.
template <class Real>
struct Planks {
    WorldState<Real> world;
    Column<Real> own_x, own_y;  // m/s, velocities without the flow
    Draw draw{7};

    Planks() : own_x(kCount), own_y(kCount) {
        world.bodies.has_rotation = world.bodies.has_shapes = true;
        const auto shape = [](std::size_t i) -> Shape {
            switch (i % 8) {
                case 5:
                    return Capsule{3, 0.05};
                case 6:
                    return Box{0.5, 0.5};
                case 7:
                    return Disc{0.3};
                default:
                    return Box{4, 0.06};
            }
        };
        for (std::size_t i = 0; i < kCount; ++i) {
            world.append(
                {.shape = shape(i), .position = {draw(0, kSide), draw(0, kSide)}, .angle = draw(-0.2, 0.2)});
            kick(i);
        }
    }
    void kick(std::size_t row) {
        const double speed = draw.below(20) == 0 ? 12 : 0.7, spin = draw.below(10) == 0 ? 20 : 0.5;
        own_x[row] = static_cast<Real>(draw(-speed, speed));
        own_y[row] = static_cast<Real>(draw(-speed, speed));
        world.bodies.angular_velocity[row] = static_cast<Real>(draw(-spin, spin));
    }
    PlacedShape placed(std::size_t row, double t) const {
        const Bodies<Real>& b = world.bodies;
        const double angle =
            static_cast<double>(b.angle[row]) + t * static_cast<double>(b.angular_velocity[row]);
        const double pose[] = {centre(row, t).x, centre(row, t).y, std::cos(angle), std::sin(angle)};
        const auto real = [](double value) { return static_cast<Real>(value); };
        const Real rounded[] = {real(pose[0]), real(pose[1]), real(pose[2]), real(pose[3])};
        return place(world.shapes[b.shape[row]], rounded);
    }
    /// Pairs that meet at the start, the middle or the end of the coming step, by the distance of their
    /// shapes; those whose discs do not meet then need no look.
    std::set<std::pair<std::int32_t, std::int32_t>> meetings() const {
        std::set<std::pair<std::int32_t, std::int32_t>> found;
        for (const double t : {0.0, 0.5 * kStep, kStep}) {
            std::vector<PlacedShape> shapes;
            for (std::size_t row = 0; row < kCount; ++row) shapes.push_back(placed(row, t));
            for (std::size_t a = 0; a < kCount; ++a)
                for (std::size_t b = a + 1; b < kCount; ++b) {
                    const Vec2 d = centre(b, t) - centre(a, t);
                    const double reach = static_cast<double>(world.bodies.radius[a] + world.bodies.radius[b]);
                    if (dot(d, d) > 1.001 * reach * reach || signed_distance(shapes[a], shapes[b]) > 0)
                        continue;
                    found.insert({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)});
                }
        }
        return found;
    }
    Vec2 centre(std::size_t row, double t) const {
        const Bodies<Real>& b = world.bodies;
        return {static_cast<double>(b.position_x[row]) + t * static_cast<double>(b.velocity_x[row]),
                static_cast<double>(b.position_y[row]) + t * static_cast<double>(b.velocity_y[row])};
    }
    void move() {
        Bodies<Real>& b = world.bodies;
        const auto dt = static_cast<Real>(kStep);
        for (std::size_t row = 0; row < kCount; ++row) {
            b.position_x[row] += dt * b.velocity_x[row], b.position_y[row] += dt * b.velocity_y[row];
            b.angle[row] += dt * b.angular_velocity[row];
            if (draw.below(40) == 0) kick(row);
        }
    }
};

struct Counts {
    std::size_t meetings = 0, pairs = 0, pairs_of_discs = 0;
    std::int64_t rebuilds = 0;
};

template <class Real>
Counts fly(const std::function<Vec2(Vec2)>& flow) {
    Planks<Real> planks;
    Bodies<Real>& bodies = planks.world.bodies;
    Candidates<Real> candidates(MarginRule::own);
    candidates.prepare(kCount);
    const KernelTable<Real>& kernels = select_kernels("auto").template of<Real>();
    std::set<std::pair<std::int32_t, std::int32_t>> known;
    Counts counts;
    for (int step = 0; step < 90; ++step) {
        for (std::size_t row = 0; row < kCount; ++row) {
            const Vec2 v = flow({bodies.position_x[row], bodies.position_y[row]});
            bodies.velocity_x[row] = planks.own_x[row] + static_cast<Real>(v.x);
            bodies.velocity_y[row] = planks.own_y[row] + static_cast<Real>(v.y);
        }
        candidates.move_places(bodies, kStep, Executor());
        std::vector<std::int32_t> displaced;
        for (std::size_t row = 0; row < kCount && candidates.is_valid(); ++row) {
            const auto end = [&](const Column<Real>& x, const Column<Real>& v) {
                return static_cast<double>(x[row]) + kStep * static_cast<double>(v[row]);
            };
            const Vec2 way =
                Vec2{end(bodies.position_x, bodies.velocity_x), end(bodies.position_y, bodies.velocity_y)} -
                Vec2{candidates.built_x()[row], candidates.built_y()[row]};
            const double margin = static_cast<double>(candidates.reach()[row] - bodies.radius[row]);
            if (dot(way, way) >= margin * margin) displaced.push_back(static_cast<std::int32_t>(row));
        }
        const std::int64_t rebuilds = candidates.rebuild_count();
        candidates.update(bodies, flight_clock_at(kStep, 0), {}, displaced, 30, kernels, Executor(),
                          &planks.world.shapes);
        if (candidates.rebuild_count() > rebuilds) {
            known.clear();
            for (std::size_t p = 0; p < candidates.pair_count(); ++p)
                known.insert(std::minmax(candidates.pair_a()[p], candidates.pair_b()[p]));
            counts.pairs += known.size();
            for (std::size_t a = 0; a < kCount; ++a)
                for (std::size_t b = a + 1; b < kCount; ++b) {
                    const Vec2 d{bodies.position_x[b] - bodies.position_x[a],
                                 bodies.position_y[b] - bodies.position_y[a]};
                    const double reach = static_cast<double>(bodies.radius[a] + bodies.radius[b]);
                    counts.pairs_of_discs += dot(d, d) < reach * reach;
                }
        }
        for (const auto& pair : candidates.new_pairs()) CHECK(known.insert({pair.a, pair.b}).second);
        const std::set<std::pair<std::int32_t, std::int32_t>> meetings = planks.meetings();
        counts.meetings += meetings.size();
        CHECK(std::includes(known.begin(), known.end(), meetings.begin(), meetings.end()));
        planks.move();
    }
    counts.rebuilds = candidates.rebuild_count();
    return counts;
}

}  // namespace

TEST_SUITE("broadphase/slim bodies") {
    TEST_CASE_TEMPLATE(
        "no meeting of planks is missed, and few pairs of those in each other's discs are kept", Real, float,
        double) {
        const auto still = [](Vec2) { return Vec2{}; };
        const auto falls = [](Vec2) { return Vec2{0, -15}; };
        const auto turns = [](Vec2 p) { return Vec2{-0.4 * (p.y - 8), 0.4 * (p.x - 8)}; };
        const auto shears = [](Vec2 p) { return Vec2{0.5 * p.y, 0}; };
        const auto closes = [](Vec2 p) { return Vec2{0, 0.4 * (8 - p.y)}; };
        using Flows = std::vector<std::function<Vec2(Vec2)>>;
        for (const auto& flow :
             scaled<Flows>({still, falls, turns, shears, closes}, {still, turns, closes})) {
            const Counts counts = fly<Real>(flow);
            CHECK(counts.meetings > 1000);
            CHECK(counts.rebuilds < 80);
            CHECK(counts.pairs < counts.pairs_of_discs);
        }
    }

    TEST_CASE("a world without slim bodies has the pairs of the discs around them") {
        SlimBodies<float> slim;
        WorldState<float> world;
        world.bodies.has_shapes = true;
        world.append({.shape = Box{1, 1}});
        slim.read_shapes(world.shapes);
        CHECK(slim.empty());
        world.append({.shape = Box{10, 0.1}});
        slim.read_shapes(world.shapes);
        CHECK(!slim.empty());
    }
}

}  // namespace test_slim_bodies

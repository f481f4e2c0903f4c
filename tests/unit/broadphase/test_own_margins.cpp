// Margins of each body's own, and places that move with the flow: whatever happens to the bodies, no two that
// meet in a step are missed.
#include "broadphase/candidates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <set>
#include <utility>

#include "isa/select_isa.hpp"
#include "support/effort.hpp"

namespace test_own_margins {

using namespace carom;

namespace {

using PairOfRows = std::pair<std::int32_t, std::int32_t>;

/// Discs that fly straight and are kicked now and then, most of them slow.
template <class Real>
struct Swarm {
    Bodies<Real> bodies;
    Column<Real> own_x, own_y;       // m/s, velocities without the flow
    double fastest = 20, usual = 1;  // m/s, of few and of most
    std::mt19937 random{5};

    explicit Swarm(std::size_t count) {
        bodies.resize(count);
        own_x.resize(count), own_y.resize(count);
        for (std::size_t row = 0; row < count; ++row) {
            bodies.position_x[row] = static_cast<Real>(uniform(0, 40));
            bodies.position_y[row] = static_cast<Real>(uniform(0, 40));
            bodies.radius.set(row, count, static_cast<Real>(uniform(0.3, 0.5)));
            kick(row);
        }
    }
    double uniform(double low, double high) {
        return low + (high - low) * static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
    }
    void kick(std::size_t row) {
        const double speed = uniform(0, 1) < 0.05 ? fastest : usual;
        own_x[row] = static_cast<Real>(uniform(-speed, speed));
        own_y[row] = static_cast<Real>(uniform(-speed, speed));
    }
    Vec2 place(std::size_t row, double t) const {
        return {
            static_cast<double>(bodies.position_x[row]) + t * static_cast<double>(bodies.velocity_x[row]),
            static_cast<double>(bodies.position_y[row]) + t * static_cast<double>(bodies.velocity_y[row])};
    }
    /// Whether two discs touch at some moment of a step.
    /// @param starts, ends  places of all discs at its start and end
    bool meet(std::size_t a, std::size_t b, const std::vector<Vec2>& starts,
              const std::vector<Vec2>& ends) const {
        const Vec2 from = starts[b] - starts[a], to = ends[b] - ends[a], way = to - from;
        const double length = dot(way, way);
        const double t = length > 0 ? std::clamp(-dot(from, way) / length, 0.0, 1.0) : 0;
        const Vec2 nearest = from + t * way;
        const double reach = static_cast<double>(bodies.radius[a]) + static_cast<double>(bodies.radius[b]);
        return dot(nearest, nearest) <= reach * reach;
    }
};

constexpr std::size_t kCount = 700;

struct Counts {
    std::size_t meetings = 0, added = 0, looks = 0, looked_up = 0;
    std::int64_t rebuilds = 0;
};

/// Looks up what some bodies would touch that were thrown by up to 2 m out of their places in this step.
template <class Real>
void look_up(Swarm<Real>& swarm, const Candidates<Real>& candidates, const std::vector<Vec2>& ends,
             Counts& counts) {
    Column<std::int32_t> found;
    const Bodies<Real>& bodies = swarm.bodies;
    for (int look = 0; look < 5; ++look) {
        const auto row = static_cast<std::size_t>(swarm.uniform(0, 0.999) * static_cast<double>(kCount - 1));
        const Vec2 at = ends[row] + Vec2{swarm.uniform(-2, 2), swarm.uniform(-2, 2)};
        const double radius = bodies.radius[row];
        const std::size_t count = candidates.find_around(row, radius, at, found);
        ++counts.looks, counts.looked_up += count;
        const std::set<std::int32_t> rows(found.data(), found.data() + count);
        std::size_t missed = 0;
        for (std::size_t other = 0; other < kCount; ++other) {
            const double reach = radius + static_cast<double>(bodies.radius[other]);
            const bool is_in_margin =
                !(candidates.outside_of_margin(other, bodies.radius[other], ends[other]) > 0);
            if (is_in_margin && length_squared(ends[other] - at) < reach * reach)
                missed += rows.count(static_cast<std::int32_t>(other)) == 0;
        }
        CHECK(missed == 0);
    }
}

/// A hundred steps; in each all bodies have the flow's velocity besides their own. Checks that every two that
/// meet are among the pairs, and that none is added that is known.
template <class Real>
Counts fly(Swarm<Real>& swarm, const std::function<Vec2(Vec2, int)>& flow) {
    constexpr double kStep = 1.0 / 60;
    Bodies<Real>& bodies = swarm.bodies;
    Candidates<Real> candidates(MarginRule::own);
    candidates.prepare(kCount);
    const FlightClock end = flight_clock_at(kStep, 0);
    const KernelTable<Real>& kernels = select_kernels("auto").template of<Real>();
    std::set<PairOfRows> known;
    Counts counts;
    for (int step = 0; step < 100; ++step) {
        for (std::size_t row = 0; row < kCount; ++row) {
            const Vec2 v = flow({bodies.position_x[row], bodies.position_y[row]}, step);
            bodies.velocity_x[row] = swarm.own_x[row] + static_cast<Real>(v.x);
            bodies.velocity_y[row] = swarm.own_y[row] + static_cast<Real>(v.y);
        }
        candidates.move_places(bodies, kStep, Executor());
        std::vector<std::int32_t> displaced;
        for (std::size_t row = 0; row < kCount && candidates.is_valid(); ++row) {
            const Vec2 way =
                swarm.place(row, kStep) - Vec2{candidates.built_x()[row], candidates.built_y()[row]};
            const double margin = static_cast<double>(candidates.reach()[row] - bodies.radius[row]);
            if (dot(way, way) >= margin * margin) displaced.push_back(static_cast<std::int32_t>(row));
        }
        const std::int64_t rebuilds = candidates.rebuild_count();
        candidates.update(bodies, end, {}, displaced, 30, kernels, Executor());
        if (candidates.rebuild_count() > rebuilds) {
            known.clear();
            for (std::size_t p = 0; p < candidates.pair_count(); ++p)
                known.insert(std::minmax(candidates.pair_a()[p], candidates.pair_b()[p]));
        }
        for (const auto& pair : candidates.new_pairs()) {
            CHECK(known.insert({pair.a, pair.b}).second);
            ++counts.added;
        }
        std::vector<Vec2> starts, ends;
        for (std::size_t row = 0; row < kCount; ++row)
            starts.push_back(swarm.place(row, 0)), ends.push_back(swarm.place(row, kStep));
        std::size_t missed = 0;
        for (std::size_t a = 0; a < kCount; ++a)
            for (std::size_t b = a + 1; b < kCount; ++b) {
                if (!swarm.meet(a, b, starts, ends)) continue;
                ++counts.meetings;
                missed += known.count({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)}) == 0;
            }
        CHECK(missed == 0);
        look_up(swarm, candidates, ends, counts);
        for (std::size_t row = 0; row < kCount; ++row) {
            bodies.position_x[row] = static_cast<Real>(ends[row].x),
            bodies.position_y[row] = static_cast<Real>(ends[row].y);
            if (swarm.uniform(0, 1) < 0.02) swarm.kick(row);
        }
    }
    counts.rebuilds = candidates.rebuild_count();
    return counts;
}

}  // namespace

TEST_SUITE("broadphase/own margins") {
    TEST_CASE_TEMPLATE("over a hundred steps of kicked bodies no meeting is missed and no pair comes twice",
                       Real, float, double) {
        Swarm<Real> swarm(kCount);
        const Counts counts = fly<Real>(swarm, [](Vec2, int) { return Vec2{}; });
        CHECK(counts.meetings > 1000);
        CHECK(counts.added > 100);    // margins were renewed,
        CHECK(counts.rebuilds < 60);  // and that saves finding all pairs anew
        CHECK(counts.rebuilds > 1);
    }

    TEST_CASE_TEMPLATE("in a flow that turns, shears, closes and turns back no meeting is missed", Real,
                       float, double) {
        // m/s at a place, in a step: 3 m/s at the rim, many times what a margin allows.
        const auto turn = [](Vec2 p, int step) {
            const double spin = step < 60 ? 0.15 : -0.15;
            return Vec2{-spin * (p.y - 20), spin * (p.x - 20)};
        };
        const auto heave = [](Vec2 p, int step) {
            return Vec2{0, 0.1 * p.y * std::sin(0.08 * static_cast<double>(step))};
        };
        const auto layers = [](Vec2 p, int) { return Vec2{p.y < 20 ? 3.0 : -3.0, 0}; };
        const auto sideways = [](Vec2, int) { return Vec2{4, 0}; };
        using Flows = std::vector<std::function<Vec2(Vec2, int)>>;
        for (const auto& flow : test::scaled<Flows>({turn, heave, layers, sideways}, {turn, layers})) {
            Swarm<Real> swarm(kCount);
            swarm.fastest = 1.5, swarm.usual = 0.2;
            for (std::size_t row = 0; row < kCount; ++row) swarm.kick(row);
            const Counts counts = fly<Real>(swarm, flow);
            CHECK(counts.meetings > 500);
            CHECK(counts.rebuilds < 45);
        }
    }

    // All were looked at wherever places drifted apart, once for each impact of a body that left its margin.
    TEST_CASE_TEMPLATE("beside a huge body what small ones may meet is looked up among few", Real, float,
                       double) {
        Swarm<Real> swarm(kCount);
        swarm.fastest = 1.5, swarm.usual = 0.2;
        for (std::size_t row = 0; row < kCount; ++row) swarm.kick(row);
        Bodies<Real>& bodies = swarm.bodies;
        const std::size_t huge = kCount - 1;
        bodies.position_x[huge] = Real(-95), bodies.position_y[huge] = Real(20);
        bodies.radius.set(huge, kCount, Real(100));
        bodies.set_flags(huge, kImmovable | kNotDisc);  // sizes are chosen without it, as without long walls
        const Counts counts = fly<Real>(swarm, [](Vec2 p, int) {
            return p.x < -50 ? Vec2{} : Vec2{-0.15 * (p.y - 20), 0.15 * (p.x - 20)};
        });
        CHECK(counts.meetings > 500);
        CHECK(counts.looked_up < 5 * counts.looks);  // 22 of 700 each when all were
    }

    TEST_CASE_TEMPLATE("bodies that only follow a flow which brings them nearer are found in time", Real,
                       float, double) {
        Swarm<Real> swarm(kCount);
        swarm.fastest = swarm.usual = 0;
        for (std::size_t row = 0; row < kCount; ++row) swarm.kick(row);
        const Counts counts = fly<Real>(swarm, [](Vec2 p, int) { return 0.3 * Vec2{20 - p.x, 20 - p.y}; });
        CHECK(counts.meetings > 1000);
    }

    TEST_CASE("places go with the flow, so that pairs outlast many margins") {
        Swarm<float> swarm(kCount);
        swarm.fastest = swarm.usual = 0;
        for (std::size_t row = 0; row < kCount; ++row) swarm.kick(row);
        const Counts counts = fly<float>(swarm, [](Vec2, int) { return Vec2{1, 0}; });
        CHECK(counts.added == 0);
        CHECK(counts.rebuilds == 1);  // 1.7 m in 100 steps, a margin being 0.06 m
    }
}

}  // namespace test_own_margins

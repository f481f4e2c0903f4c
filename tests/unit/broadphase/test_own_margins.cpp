// Margins of each body's own: whatever happens to the bodies, no two that meet in a step are missed.
#include "broadphase/candidates.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "isa/select_isa.hpp"

using namespace carom;

namespace {

using PairOfRows = std::pair<std::int32_t, std::int32_t>;

/// Discs that fly straight and are kicked now and then, most of them slow.
template <class Real>
struct Swarm {
    Bodies<Real> bodies;
    std::mt19937 random{5};

    explicit Swarm(std::size_t count) {
        bodies.resize(count);
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
        const double speed = uniform(0, 1) < 0.05 ? 20 : 1;  // m/s
        bodies.velocity_x[row] = static_cast<Real>(uniform(-speed, speed));
        bodies.velocity_y[row] = static_cast<Real>(uniform(-speed, speed));
    }
    Vec2 place(std::size_t row, double t) const {
        return {
            static_cast<double>(bodies.position_x[row]) + t * static_cast<double>(bodies.velocity_x[row]),
            static_cast<double>(bodies.position_y[row]) + t * static_cast<double>(bodies.velocity_y[row])};
    }
    /// Whether two discs touch at some moment of [0, h].
    bool meet(std::size_t a, std::size_t b, double h) const {
        const Vec2 from = place(b, 0) - place(a, 0), to = place(b, h) - place(a, h), way = to - from;
        const double length = dot(way, way);
        const double t = length > 0 ? std::clamp(-dot(from, way) / length, 0.0, 1.0) : 0;
        const Vec2 nearest = from + t * way;
        const double reach = static_cast<double>(bodies.radius[a]) + static_cast<double>(bodies.radius[b]);
        return dot(nearest, nearest) <= reach * reach;
    }
};

}  // namespace

TEST_SUITE("broadphase/own margins") {
    TEST_CASE_TEMPLATE("over a hundred steps of kicked bodies no meeting is missed and no pair comes twice",
                       Real, float, double) {
        constexpr std::size_t kCount = 700;
        constexpr double kStep = 1.0 / 60;
        Swarm<Real> swarm(kCount);
        Bodies<Real>& bodies = swarm.bodies;
        Candidates<Real> candidates(MarginRule::own);
        candidates.prepare(kCount);
        const FlightClock end = flight_clock_at(kStep, 0);
        const KernelTable<Real>& kernels = select_kernels("auto").template of<Real>();
        std::set<PairOfRows> known;
        std::size_t meetings = 0, added = 0;
        for (int step = 0; step < 100; ++step) {
            std::vector<std::int32_t> displaced;
            for (std::size_t row = 0; row < kCount && candidates.is_valid(); ++row)
                if (candidates.overshoot_of(static_cast<std::int32_t>(row), bodies.radius[row],
                                            swarm.place(row, kStep)) > 0)
                    displaced.push_back(static_cast<std::int32_t>(row));
            const std::int64_t rebuilds = candidates.rebuild_count();
            candidates.update(bodies, end, {}, displaced, 30, kernels, Executor());
            if (candidates.rebuild_count() > rebuilds) {
                known.clear();
                for (std::size_t p = 0; p < candidates.pair_count(); ++p)
                    known.insert(std::minmax(candidates.pair_a()[p], candidates.pair_b()[p]));
            }
            for (const auto& pair : candidates.new_pairs()) {
                CHECK(known.insert({pair.a, pair.b}).second);
                ++added;
            }
            std::size_t missed = 0;
            for (std::size_t a = 0; a < kCount; ++a)
                for (std::size_t b = a + 1; b < kCount; ++b) {
                    if (!swarm.meet(a, b, kStep)) continue;
                    ++meetings;
                    missed += known.count({static_cast<std::int32_t>(a), static_cast<std::int32_t>(b)}) == 0;
                }
            CHECK(missed == 0);
            for (std::size_t row = 0; row < kCount; ++row) {
                const Vec2 to = swarm.place(row, kStep);
                bodies.position_x[row] = static_cast<Real>(to.x),
                bodies.position_y[row] = static_cast<Real>(to.y);
                if (swarm.uniform(0, 1) < 0.02) swarm.kick(row);
            }
        }
        CHECK(meetings > 1000);
        CHECK(added > 100);                      // margins were renewed,
        CHECK(candidates.rebuild_count() < 60);  // and that saves finding all pairs anew
        CHECK(candidates.rebuild_count() > 1);
    }
}

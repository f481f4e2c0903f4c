// The calendar of impacts against a sorted set, and the lists of tiles.
#include "solvers/impulse/impacts/impact_lists.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace test_impact_calendar {

using namespace carom;

namespace {

constexpr double kEnd = 0.016;  // the clock at the end of a substep

using Key = std::tuple<double, std::int32_t, std::int32_t>;

Key key_of(const Impact& impact) {
    return {impact.s, impact.meeting.a, impact.meeting.b};
}

struct Draw {
    std::mt19937 random;
    double clustered;  // share of impacts that fall into one moment

    double between(double low, double high) {
        return low + (high - low) * static_cast<double>(random() % 1000001) * 1e-6;
    }
    /// Not before `now`; ties in time are common.
    Impact impact(double now) {
        const bool is_clustered = between(0, 1) < clustered;
        const double s = is_clustered ? std::fmax(now, 0.25 * kEnd) : between(now, kEnd);
        return {
            s, {static_cast<std::int32_t>(random() % 500), static_cast<std::int32_t>(random() % 500)}, 0, 0};
    }
};

}  // namespace

TEST_SUITE("solvers/impulse/impact_calendar") {
    TEST_CASE("impacts come in the order of time, ties by row, also those that are foreseen on the way") {
        ImpactCalendar calendar;
        for (const double clustered : {0.0, 0.5, 1.0})
            for (const std::size_t expected : {0u, 1u, 1000u}) {
                CAPTURE(clustered);
                CAPTURE(expected);
                Draw draw{std::mt19937(9), clustered};
                std::multiset<Key> reference;
                calendar.start(kEnd, expected);
                const auto push = [&](double now) {
                    const Impact impact = draw.impact(now);
                    calendar.push(impact), reference.insert(key_of(impact));
                };
                for (int i = 0; i < 1000; ++i) push(0);
                std::size_t wrong = 0, carried_out = 0;
                while (!calendar.empty()) {
                    const Impact impact = calendar.next();
                    REQUIRE_FALSE(reference.empty());
                    wrong += key_of(impact) != *reference.begin();
                    reference.erase(reference.begin());
                    calendar.pop();
                    CHECK(calendar.size() == reference.size());
                    if (++carried_out < 3000 && draw.random() % 4 != 0) push(impact.s);
                }
                CHECK(wrong == 0);
                CHECK(reference.empty());
                CHECK(carried_out > 1500);
            }
    }

    TEST_CASE("an impact at the very end, and a substep of no length, are in order too") {
        ImpactCalendar calendar;
        for (const double end : {kEnd, 0.0}) {
            calendar.start(end, 3);
            calendar.push({end, {2, 3}, 0, 0}), calendar.push({end, {1, 9}, 0, 0});
            calendar.push({0, {5, -1}, 0, 0}), calendar.push({end, {1, 4}, 0, 0});
            std::vector<Key> order;
            for (; !calendar.empty(); calendar.pop()) order.push_back(key_of(calendar.next()));
            const std::vector<Key> sorted = {{end, 1, 4}, {end, 1, 9}, {end, 2, 3}};
            if (end > 0) CHECK(order == std::vector<Key>{{0, 5, -1}, sorted[0], sorted[1], sorted[2]});
            if (end == 0) CHECK(order == std::vector<Key>{sorted[0], sorted[1], sorted[2], {0, 5, -1}});
        }
    }

    TEST_CASE("a tile gets the impacts foreseen before and those that cross into it, each once") {
        constexpr std::size_t kTiles = 12;
        ImpactLists lists;
        for (int round = 0; round < 3; ++round) {  // what the round before has left must not matter
            Draw draw{std::mt19937(static_cast<unsigned>(20 + round)), 0.1};
            std::vector<std::multiset<Key>> waiting(kTiles);
            std::vector<std::size_t> foreseen_of(kTiles);
            const auto some = [&] {
                const std::size_t tile = draw.random() % kTiles;
                const PlacedImpact placed{draw.impact(0), static_cast<std::uint32_t>(tile == 5 ? 6 : tile)};
                waiting[placed.tile].insert(key_of(placed.impact));
                return placed;  // one tile is empty
            };
            std::vector<PlacedImpact> foreseen;
            for (int i = 0; i < 1000; ++i) {
                foreseen.push_back(some());
                ++foreseen_of[foreseen.back().tile];
            }
            lists.begin(foreseen, kTiles);
            for (int i = 0; i < 300; ++i) lists.add(some());
            for (std::size_t tile = 0; tile < kTiles; ++tile) {
                std::multiset<Key> found;
                lists.for_each_of(tile, [&](const Impact& impact) { found.insert(key_of(impact)); });
                CHECK(found == waiting[tile]);
                CHECK(lists.expected(tile) == foreseen_of[tile]);
            }
        }
    }
}

}  // namespace test_impact_calendar

// The calendar of impacts against a sorted set, and the queue of tiles against the order it promises.
#include "solvers/impulse/impact_queue.hpp"

#include <doctest/doctest.h>

#include <cstdint>
#include <random>
#include <set>
#include <tuple>
#include <vector>

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

TEST_SUITE("solvers/impact queue") {
    TEST_CASE("impacts come in the order of time, ties by row, also those that are foreseen on the way") {
        ImpactQueue queue;
        for (const double clustered : {0.0, 0.5, 1.0})
            for (const std::size_t expected : {0u, 1u, 1000u}) {
                CAPTURE(clustered);
                CAPTURE(expected);
                Draw draw{std::mt19937(9), clustered};
                std::multiset<Key> reference;
                queue.start(kEnd, expected, 1);
                const auto push = [&](double now) {
                    const Impact impact = draw.impact(now);
                    queue.push(impact, 0), reference.insert(key_of(impact));
                };
                for (int i = 0; i < 1000; ++i) push(0);
                std::size_t wrong = 0, carried_out = 0;
                while (const Impact* next = queue.next([](std::size_t) {})) {
                    const Impact impact = *next;
                    REQUIRE_FALSE(reference.empty());
                    wrong += key_of(impact) != *reference.begin();
                    reference.erase(reference.begin());
                    queue.pop();
                    CHECK(queue.size() == reference.size());
                    if (++carried_out < 3000 && draw.random() % 4 != 0) push(impact.s);
                }
                CHECK(wrong == 0);
                CHECK(reference.empty());
                CHECK(carried_out > 1500);
            }
    }

    TEST_CASE("an impact at the very end, and a substep of no length, are in order too") {
        ImpactQueue queue;
        for (const double end : {kEnd, 0.0}) {
            queue.start(end, 3, 1);
            queue.push({end, {2, 3}, 0, 0}, 0), queue.push({end, {1, 9}, 0, 0}, 0);
            queue.push({0, {5, -1}, 0, 0}, 0), queue.push({end, {1, 4}, 0, 0}, 0);
            std::vector<Key> order;
            for (; const Impact* next = queue.next([](std::size_t) {}); queue.pop())
                order.push_back(key_of(*next));
            const std::vector<Key> sorted = {{end, 1, 4}, {end, 1, 9}, {end, 2, 3}};
            if (end > 0) CHECK(order == std::vector<Key>{{0, 5, -1}, sorted[0], sorted[1], sorted[2]});
            if (end == 0) CHECK(order == std::vector<Key>{sorted[0], sorted[1], sorted[2], {0, 5, -1}});
        }
    }

    TEST_CASE("tiles come one after the other, each in the order of time, and none is lost across borders") {
        constexpr std::size_t kTiles = 12;
        ImpactQueue queue;
        for (int round = 0; round < 3; ++round) {  // what the round before has left must not matter
            Draw draw{std::mt19937(static_cast<unsigned>(20 + round)), 0.1};
            std::vector<std::multiset<Key>> waiting(kTiles);
            queue.start(kEnd, 1000, kTiles);
            std::size_t pushed = 0, tile = 0, wrong = 0, carried_out = 0;
            bool has_begun = false;
            const auto push = [&](double now, std::size_t of) {
                const Impact impact = draw.impact(now);
                queue.push(impact, of), ++pushed;
                // A tile that is over cannot begin again: its impacts are done in the present one.
                waiting[has_begun ? std::max(of, tile) : of].insert(key_of(impact));
            };
            const auto some_tile = [&] {
                const std::size_t of = draw.random() % kTiles;
                return of == 5 ? 6 : of;  // one is empty
            };
            for (int i = 0; i < 1000; ++i) push(0, some_tile());
            std::vector<std::size_t> begun;
            while (true) {
                const Impact* next = queue.next([&](std::size_t of) {
                    wrong += has_begun && !waiting[tile].empty();
                    begun.push_back(of), tile = of, has_begun = true;
                });
                if (!next) break;
                const Impact impact = *next;
                REQUIRE_FALSE(waiting[tile].empty());
                wrong += key_of(impact) != *waiting[tile].begin();
                waiting[tile].erase(waiting[tile].begin());
                queue.pop(), ++carried_out;
                if (pushed < 4000 && draw.random() % 4 != 0)
                    push(impact.s, draw.random() % 2 == 0 ? tile : some_tile());
            }
            CHECK(wrong == 0);
            CHECK(carried_out == pushed);
            CHECK(queue.size() == 0);
            CHECK(begun == std::vector<std::size_t>{0, 1, 2, 3, 4, 6, 7, 8, 9, 10, 11});
        }
    }
}

// The tree of boxes over the edges of a body, against all edges one by one.
#include "shapes/edges.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "narrowphase/disc_edge.hpp"

namespace test_edges {

using namespace carom;

namespace {

/// A chain that wanders about, of steps of up to a metre.
Chain wandering(std::size_t points, std::mt19937& random, bool loop) {
    std::uniform_real_distribution<double> step(-0.5, 1);
    Chain chain{{{0, 0}}, loop};
    while (chain.points.size() < points) {
        const Vec2 last = chain.points.back();
        chain.points.push_back({last.x + step(random), last.y + step(random) - 0.25});
    }
    return chain;
}

struct Asked {
    std::size_t missing = 0, twice = 0, out_of_order = 0, most = 0;
};

/// Asks for the edges of every body around places along it.
Asked ask(const EdgeStore& store, std::mt19937& random, double reach) {
    std::uniform_real_distribution<double> off(-2, 2);
    Asked asked;
    for (const EdgeBody& body : store.bodies)
        for (int i = 0; i < 200 && body.count > 0; ++i) {
            const auto some = static_cast<std::int32_t>(random() % static_cast<unsigned>(body.count));
            const Vec2 place = store[body.first + some].a + Vec2{off(random), off(random)};
            std::vector<int> seen(static_cast<std::size_t>(body.count));
            std::int32_t last = -1;
            std::size_t count = 0;
            store.for_each_near(body, place, reach, [&](std::int32_t edge) {
                asked.twice += ++seen[static_cast<std::size_t>(edge - body.first)] > 1;
                asked.out_of_order += edge <= last;
                last = edge, ++count;
            });
            asked.most = std::max(asked.most, count);
            for (std::int32_t n = 0; n < body.count; ++n) {
                const Edge& edge = store[body.first + n];
                const bool is_near = distance_squared(place, edge.a, edge.b) < reach * reach;
                asked.missing += is_near && seen[static_cast<std::size_t>(n)] == 0;
            }
        }
    return asked;
}

}  // namespace

TEST_SUITE("shapes/edges") {
    TEST_CASE("all edges near a place are found, in their order, and few others") {
        std::mt19937 random(5);
        EdgeStore store;
        for (const std::size_t points : {2u, 9u, 10u, 70u, 600u, 5000u})
            store.append({static_cast<std::uint32_t>(points), 0}, wandering(points, random, points == 70));
        store.append({1, 0}, Segment{{0, 0}, {3, 4}});
        for (const double reach : {0.0, 0.7, 5.0}) {
            CAPTURE(reach);
            const Asked asked = ask(store, random, reach);
            CHECK(asked.missing == 0);
            CHECK(asked.twice == 0);
            CHECK(asked.out_of_order == 0);
            CHECK(asked.most < 1000);  // of 5,000
        }
    }

    TEST_CASE("they are found when other bodies are gone") {
        std::mt19937 random(6);
        EdgeStore store;
        for (std::uint32_t id = 0; id < 6; ++id)
            store.append({id, 0}, wandering(40 + 30 * id, random, false));
        for (const std::uint32_t id : {3u, 0u, 5u}) {
            store.remove({id, 0});
            CHECK(ask(store, random, 1).missing == 0);
        }
        store.append({9, 0}, wandering(90, random, true));
        CHECK(ask(store, random, 1).missing == 0);
    }
}

}  // namespace test_edges

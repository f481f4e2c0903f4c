#include "sleeping/islands.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <queue>
#include <random>
#include <utility>
#include <vector>

namespace test_islands {

using carom::Islands;

namespace {

using Edges = std::vector<std::pair<std::int32_t, std::int32_t>>;

/// The smallest row that can be reached from each row, by breadth-first search.
std::vector<std::int32_t> smallest_reachable(std::size_t rows, const Edges& edges) {
    std::vector<std::vector<std::int32_t>> neighbours(rows);
    for (const auto& [a, b] : edges) {
        neighbours[static_cast<std::size_t>(a)].push_back(b);
        neighbours[static_cast<std::size_t>(b)].push_back(a);
    }
    std::vector<std::int32_t> smallest(rows, -1);
    for (std::size_t start = 0; start < rows; ++start) {
        if (smallest[start] >= 0) continue;
        std::queue<std::size_t> open({start});
        smallest[start] = static_cast<std::int32_t>(start);
        for (; !open.empty(); open.pop())
            for (const std::int32_t next : neighbours[open.front()]) {
                std::int32_t& of_next = smallest[static_cast<std::size_t>(next)];
                if (of_next >= 0) continue;
                of_next = static_cast<std::int32_t>(start);
                open.push(static_cast<std::size_t>(next));
            }
    }
    return smallest;
}

std::vector<std::int32_t> islands_of(Islands& islands, std::size_t rows) {
    std::vector<std::int32_t> found;
    for (std::size_t row = 0; row < rows; ++row)
        found.push_back(islands.island_of(static_cast<std::int32_t>(row)));
    return found;
}

}  // namespace

TEST_SUITE("sleeping/islands") {
    TEST_CASE("an island is what contacts connect, known by its smallest row, in any order of contacts") {
        std::mt19937 random(5);
        Islands islands;  // one for all: nothing of the graph before may be left
        std::size_t largest = 0;
        for (const std::size_t rows : {1u, 2u, 3u, 50u, 2000u, 10u})
            for (const double degree : {0.0, 0.5, 0.98, 1.5, 4.0}) {
                CAPTURE(rows);
                CAPTURE(degree);
                Edges edges;
                const auto count = static_cast<std::size_t>(0.5 * degree * static_cast<double>(rows));
                for (std::size_t i = 0; i < count; ++i)
                    edges.push_back({static_cast<std::int32_t>(random() % rows),
                                     static_cast<std::int32_t>(random() % rows)});
                const std::vector<std::int32_t> expected = smallest_reachable(rows, edges);
                for (int order = 0; order < 3; ++order) {
                    islands.reset(rows);
                    for (const auto& [a, b] : edges) islands.join(a, b);
                    CHECK(islands_of(islands, rows) == expected);
                    CHECK(islands_of(islands, rows) == expected);  // asking changes nothing
                    std::shuffle(edges.begin(), edges.end(), random);
                    for (auto& [a, b] : edges)
                        if (random() % 2 == 0) std::swap(a, b);
                }
                for (const std::int32_t row : expected)
                    largest = std::max(
                        largest, static_cast<std::size_t>(std::count(expected.begin(), expected.end(), row)));
            }
        CHECK(largest > 1500);
    }

    TEST_CASE("a chain joined from its end is one island") {
        constexpr std::int32_t kRows = 100'000;
        Islands islands;
        islands.reset(kRows);
        for (std::int32_t row = kRows - 1; row > 0; --row) islands.join(row, row - 1);
        CHECK(islands.island_of(kRows - 1) == 0);
        CHECK(islands.island_of(kRows / 2) == 0);
    }
}

}  // namespace test_islands

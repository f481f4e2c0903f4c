// Boxes that come and go one by one, against a look at all of them.
#include "shapes/edge_index.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace test_edge_index {

using namespace carom;

TEST_SUITE("shapes/edge_index") {
    TEST_CASE(
        "all boxes that touch one are found, in order, whatever their sizes, while others come and go") {
        std::mt19937 random(11);
        const auto uniform = [&](double low, double high) {
            return std::uniform_real_distribution<double>(low, high)(random);
        };
        const auto some_box = [&](double most) {
            const Vec2 low{uniform(-50, 50), uniform(-50, 50)};
            const double size = std::pow(10.0, uniform(-5, std::log10(most)));
            return EdgeBox{low, {low.x + size * uniform(0, 1), low.y + size * uniform(0, 1)}};
        };
        EdgeIndex index;
        std::map<std::int32_t, EdgeBox> boxes;
        std::vector<std::int32_t> found, expected;
        std::size_t touching = 0;
        for (int turn = 0; turn < 6000; ++turn) {
            const auto number = static_cast<std::int32_t>(random() % 700);
            if (turn % 3 == 0) {
                index.remove(number), boxes.erase(number);
            } else {
                const EdgeBox box = some_box(turn % 100 == 1 ? 80 : 3);
                index.insert(number, box), boxes[number] = box;
            }
            REQUIRE(index.count() == boxes.size());
            if (turn % 4 != 0) continue;
            const EdgeBox wanted = some_box(turn % 16 == 0 ? 200 : 2);
            expected.clear();
            for (const auto& [other, box] : boxes)
                if (box.low.x <= wanted.high.x && wanted.low.x <= box.high.x && box.low.y <= wanted.high.y &&
                    wanted.low.y <= box.high.y)
                    expected.push_back(other);
            index.find(wanted, found);
            REQUIRE(found == expected);
            touching += expected.size();
        }
        CHECK(touching > 1000);
    }

    TEST_CASE("boxes at the corners of cells and without a size are found") {
        EdgeIndex index;
        std::vector<std::int32_t> found;
        for (std::int32_t n = 0; n < 400; ++n) {
            const Vec2 corner{static_cast<double>(n % 20) - 10, static_cast<double>(n / 20) - 10};
            index.insert(n, {corner, n % 2 == 0 ? corner : Vec2{corner.x + 1, corner.y}});
        }
        index.find({{0, 0}, {0, 0}}, found);
        CHECK(found == std::vector<std::int32_t>{209, 210});
        index.find({{-1e9, -1e9}, {1e9, 1e9}}, found);
        CHECK(found.size() == 400);
    }
}

}  // namespace test_edge_index

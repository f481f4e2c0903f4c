#include "state/shapes.hpp"

#include "state/columns/archive.hpp"

#include <doctest/doctest.h>

#include <cstddef>
#include <cstring>
#include <map>
#include <random>
#include <vector>

namespace test_shape_store {

using namespace carom;

TEST_CASE("bodies of the same shape share one geometry until the last of them is gone") {
    ShapeStore<float> store;
    CHECK(store.empty());
    const std::int32_t box = store.add(Box{1, 2}), same = store.add(Box{1, 2}), other = store.add(Box{2, 1});
    CHECK(box == same);
    CHECK(other != box);
    CHECK(store.distinct() == 2);
    store.remove(box);
    CHECK(std::get<Box>(store.shape(box)).height == 2);
    store.remove(same);
    CHECK(store.distinct() == 1);
    CHECK(store.add(Capsule{1, 0.1}) == box);  // the number that became free
    CHECK(store[box].count == 2);
    CHECK(store.distinct() == 2);
}

TEST_CASE("discs share a geometry if their radii are the same in the world's precision") {
    ShapeStore<float> store;
    const std::int32_t disc = store.add(Disc{0.1});
    CHECK(store.add(Disc{static_cast<double>(0.1f)}) == disc);
    CHECK(store.add(Disc{0.2}) != disc);
}

TEST_CASE("a stored polygon comes back around its centroid and is then the same shape") {
    ShapeStore<double> store;
    const Polygon polygon{{{5, 1}, {4, 3}, {2, 2}}, 0.5};
    const std::int32_t number = store.add(polygon);
    const auto back = std::get<Polygon>(store.shape(number));
    CHECK(back.vertices.size() == 3);
    CHECK(back.radius == 0.5);
    for (std::size_t i = 0; i < 3; ++i) {
        CHECK(back.vertices[i].x == store[number].x[i]);
        CHECK(back.vertices[i].y == store[number].y[i]);
    }
}

TEST_CASE("a store holds what was added and not removed, through thousands of both and a snapshot") {
    std::mt19937 random(3);
    ShapeStore<float> store;
    std::map<int, std::pair<int, std::int32_t>> bodies_of;  // by tenths of a width: how many, and the number
    const auto check = [&](const ShapeStore<float>& checked) {
        CHECK(checked.distinct() == bodies_of.size());
        for (const auto& [width, of] : bodies_of)
            REQUIRE(std::get<Box>(checked.shape(of.second)).width == 0.1 * width);
    };
    for (int round = 0; round < 20000; ++round) {
        const int width = 1 + static_cast<int>(random() % 300);
        const auto known = bodies_of.find(width);
        if (random() % 2) {
            const std::int32_t number = store.add(Box{0.1 * width, 1});
            if (known != bodies_of.end()) REQUIRE(known->second.second == number);
            auto& of = bodies_of[width];
            ++of.first, of.second = number;
        } else if (known != bodies_of.end()) {
            store.remove(known->second.second);
            if (--known->second.first == 0) bodies_of.erase(known);
        }
    }
    check(store);
    StateSize size;
    size(store);
    std::vector<std::byte> bytes(size.bytes());
    StateWriter(bytes.data())(store);
    ShapeStore<float> restored;
    StateReader(bytes.data())(restored);
    check(restored);
    for (const auto& [width, of] : bodies_of) CHECK(restored.add(Box{0.1 * width, 1}) == of.second);
}

}  // namespace test_shape_store

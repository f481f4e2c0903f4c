#include "solvers/manifolds/list/manifold_index.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <vector>

namespace test_manifold_index {

using namespace carom;

namespace {

BodyId body(std::uint32_t index) {
    return {.index = index, .generation = 1};
}

/// Contacts that carry something.
ManifoldList<float> loaded(const std::vector<ManifoldName>& names) {
    ManifoldList<float> list;
    for (const ManifoldName& name : names) list.add(0, 1, name), list.memory.back().normal1 = 1;
    return list;
}

/// Contacts that for_each_like() calls with.
std::vector<std::size_t> like(const ManifoldIndex& index, const ManifoldName& name) {
    std::vector<std::size_t> found;
    index.for_each_like(name, [&](std::size_t i) { found.push_back(i); });
    return found;
}

}  // namespace

TEST_SUITE("solvers/manifolds/manifold_index") {
    TEST_CASE("a contact is found by its name and by the reverse of it, pieces and sides included") {
        const std::vector<ManifoldName> names{{body(3), body(7), 0},
                                              {body(3), body(7), ManifoldName::place_of_pieces(2, 5)},
                                              {body(9), body(3), ManifoldName::place_of_pieces(0, 4)},
                                              {body(3), BodyId{}, ManifoldName::place_of_side(2, 1)}};
        ManifoldIndex index;
        index.file(loaded(names));
        for (std::size_t i = 0; i < names.size(); ++i) {
            CAPTURE(i);
            const auto by_name = like(index, names[i]);
            CHECK(std::count(by_name.begin(), by_name.end(), i) == 1);
            if (names[i].b == BodyId{}) continue;  // nothing looks for a wall first
            const auto reversed = like(index, names[i].reversed());
            CHECK(std::count(reversed.begin(), reversed.end(), i) == 1);
        }
    }

    TEST_CASE("contacts that carry nothing and have no place along a path are not filed") {
        ManifoldList<float> list =
            loaded({{body(1), body(2), 0}, {body(1), body(3), 0}, {body(1), body(4), 0}});
        list.memory[0].normal1 = list.memory[1].normal1 = 0;
        list.memory[1].slot = 5;
        ManifoldIndex index;
        CHECK(like(index, list.names[0]).empty());  // nothing is filed yet
        index.file(list);
        CHECK(like(index, list.names[0]).empty());
        CHECK(like(index, list.names[1]) == std::vector<std::size_t>{1});
        CHECK(like(index, list.names[2]) == std::vector<std::size_t>{2});
    }

    // Filed by their first body alone, each would be looked for among all of the drum's: 2,000 and more.
    TEST_CASE("thousands of contacts with one body, a drum or a bin, are told apart") {
        constexpr std::uint32_t kDrum = 0, kBodies = 2000;
        for (const bool drum_is_first : {true, false}) {
            CAPTURE(drum_is_first);
            std::vector<ManifoldName> names;
            for (std::uint32_t i = 1; i <= kBodies; ++i)
                names.push_back(drum_is_first ? ManifoldName{body(kDrum), body(i), 0}
                                              : ManifoldName{body(i), body(kDrum), 0});
            ManifoldIndex index;
            index.file(loaded(names));
            std::size_t looks = 0, most = 0;
            for (const ManifoldName& name : names) {
                const std::size_t count = like(index, name).size();
                looks += count, most = std::max(most, count);
            }
            CHECK(looks < 3 * std::size_t{kBodies});  // random files: 2 in the mean
            CHECK(most < 16);
        }
    }
}

}  // namespace test_manifold_index

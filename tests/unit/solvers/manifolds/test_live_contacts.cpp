// The contacts that can touch, against a list that is made anew in every step.
#include "solvers/manifolds/list/live_contacts.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <set>
#include <vector>

namespace test_live_contacts {

using namespace carom;

TEST_SUITE("solvers/manifolds/live_contacts") {
    TEST_CASE("are those of the masks, and what was found among them, whatever comes and goes") {
        std::mt19937 random(4);
        LiveContacts live;
        std::size_t blocks = 3, same = 0, known = 0;
        std::vector<bool> can_touch(kRowPadding * blocks);
        std::vector<std::int32_t> before;
        for (int step = 0; step < 400; ++step) {
            CAPTURE(step);
            const bool starts_anew = step % 90 == 0;
            if (starts_anew)
                live.clear(), before.clear(), blocks = 3, can_touch.assign(kRowPadding * blocks, false);
            std::set<std::uint32_t> found;
            if (random() % 7 == 0) found.insert(static_cast<std::uint32_t>(blocks++));
            for (std::uint32_t block = 0; block < blocks; ++block)
                if (starts_anew || random() % 3 == 0) found.insert(block);
            can_touch.resize(kRowPadding * blocks);
            const bool is_calm = random() % 2 == 0;
            live.begin(blocks);
            for (const std::uint32_t block : found) {
                std::uint16_t mask = 0;
                for (std::size_t k = 0; k < kRowPadding; ++k) {
                    const std::size_t i = kRowPadding * block + k;
                    if (!is_calm && random() % 4 == 0) can_touch[i] = random() % 2 == 0;
                    if (can_touch[i]) mask = static_cast<std::uint16_t>(mask | 1u << k);
                }
                live.set(block, mask);
            }
            const std::size_t surfaces = is_calm && step > 0 ? 5 : random() % 6;
            const auto is_live = [&](std::size_t i) { return i % 2 == 0; };
            const auto is_found = [&](std::size_t i) { return i % 4 == 0; };
            const std::vector<std::uint32_t> found_blocks(found.begin(), found.end());
            const bool is_same = live.list(found_blocks, surfaces, is_live, is_found);
            std::vector<std::int32_t> expected, expected_found;
            for (std::size_t i = 0; i < can_touch.size(); ++i) {
                if (!can_touch[i]) continue;
                if (found.count(static_cast<std::uint32_t>(i / kRowPadding)) > 0)
                    expected_found.push_back(static_cast<std::int32_t>(expected.size()));
                expected.push_back(static_cast<std::int32_t>(i));
            }
            for (std::size_t i = 0; i < surfaces; i += 2) {
                if (is_found(i)) expected_found.push_back(static_cast<std::int32_t>(expected.size()));
                expected.push_back(~static_cast<std::int32_t>(i));
            }
            REQUIRE(std::ranges::equal(live.numbers(), expected));
            REQUIRE(std::ranges::equal(live.found(), expected_found));
            for (std::size_t block = 0; block < blocks; ++block)
                for (std::size_t k = 0; k < kRowPadding; ++k)
                    REQUIRE((live.mask(block) >> k & 1) == int{can_touch[kRowPadding * block + k]});
            REQUIRE(live.mask(blocks) == 0);
            REQUIRE(is_same == (expected == before));
            same += is_same;
            if (before.empty() || expected.empty()) {
                REQUIRE(live.changed_share() < 0);
            } else {
                std::vector<std::int32_t> changed;
                std::set_symmetric_difference(
                    expected.begin(),
                    std::find_if(expected.begin(), expected.end(), [](auto n) { return n < 0; }),
                    before.begin(), std::find_if(before.begin(), before.end(), [](auto n) { return n < 0; }),
                    std::back_inserter(changed));
                REQUIRE(live.changed_share() ==
                        static_cast<double>(changed.size()) / static_cast<double>(expected.size()));
                ++known;
            }
            before = expected;
        }
        CHECK(same > 10);
        CHECK(known > 300);
    }
}

}  // namespace test_live_contacts

// The matrix of `carom torture`: its cases are scenes that the engine takes, told apart by their names; what
// a number is beside its mark.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "torture/envelopes/envelope.hpp"
#include "torture/hard/hard_case.hpp"

namespace test_hard_cases {

namespace {

using namespace carom;
using namespace carom::torture;

TEST_SUITE("unit/hard cases") {
    TEST_CASE("cases and envelopes have names of their own, and scenes that `auto` takes") {
        for (const bool is_short : {false, true}) {
            std::set<std::string> names;
            for (const HardCase& each : all_hard_cases({.is_short = is_short})) {
                CAPTURE(each.name);
                CHECK(names.insert(each.name).second);
                CHECK((each.code.size() >= 2 && (each.code[0] == 'A' || each.code[0] == 'B')));
                if (is_short) CHECK(World(each.make(), {.threads = 1}).body_count() > 0);
            }
            CHECK(names.size() > 60);
        }
        std::set<std::string> titles;
        for (const Envelope& each : all_envelopes()) {
            CAPTURE(each.title);
            CHECK(titles.insert(each.title).second);
            CHECK(!each.seeds.empty());
            CHECK(each.range.first < each.range.last);
            CHECK(World(each.make(each.range.first, each.seeds.front()), {.threads = 1}).body_count() > 0);
        }
    }
    TEST_CASE("a number takes up a share of its mark, on either side of it") {
        const double kNone = std::numeric_limits<double>::quiet_NaN();
        const auto share = [](double value, double mark, Sense sense = Sense::at_most) {
            return Measure{"", value, mark, sense}.share();
        };
        const auto passes = [](double value, double mark, Sense sense = Sense::at_most) {
            return Measure{"", value, mark, sense}.passes();
        };
        CHECK(share(1, 4) == 0.25);
        CHECK(share(8, 4) == 2);
        CHECK(share(-1, 4) == 0);
        CHECK(share(0, 0) == 0);
        CHECK(std::isinf(share(1, 0)));
        CHECK(std::isinf(share(kNone, 4)));
        CHECK(share(8, 4, Sense::at_least) == 0.5);
        CHECK(share(2, 4, Sense::at_least) == 2);
        CHECK(std::isinf(share(-1, 4, Sense::at_least)));
        CHECK(passes(4, 4));
        CHECK(!passes(4.1, 4));
        CHECK(passes(4, 4, Sense::at_least));
        CHECK(!passes(3.9, 4, Sense::at_least));
        CHECK(!passes(kNone, 4));
        CHECK(!passes(kNone, 4, Sense::at_least));
        CHECK(Measure{"", kNone}.passes());
    }
    TEST_CASE("the largest of some numbers stays none once one is") {
        Largest largest;
        largest.take(2), largest.take(1);
        CHECK(largest.value() == 2);
        largest.take(std::numeric_limits<double>::quiet_NaN()), largest.take(3);
        CHECK(std::isnan(largest.value()));
    }
}

}  // namespace

}  // namespace test_hard_cases

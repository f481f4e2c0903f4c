// Envelopes of `carom torture`: the bisection, against limits that are known.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "torture/envelopes/bracket.hpp"

namespace test_brackets {

namespace {

using namespace carom::torture;

struct Search {
    Bracket bracket;
    std::vector<double> tried;
};

/// What is found if everything up to `limit` holds, and time is up after so many runs.
Search search(const Range& range, double limit, std::size_t most_runs = 1000) {
    Search found;
    const auto probe = [&](double value, std::string& why) {
        if (found.tried.size() == most_runs) return Verdict::out_of_time;
        found.tried.push_back(value);
        if (value <= limit) return Verdict::holds;
        why = "too much at " + std::to_string(value);
        return Verdict::fails;
    };
    int reports = 0;
    found.bracket = bracket_of(range, probe, [&](const Bracket&) { ++reports; });
    CHECK(reports == found.bracket.runs);
    return found;
}

TEST_SUITE("unit/brackets") {
    TEST_CASE("a limit lies in the bracket, which is as narrow as asked") {
        const Range range{.first = 1, .last = 1e6, .stride = 10, .narrow = 1.5};
        for (const double limit : {1.0, 3.0, 9.99, 10.0, 12345.0, 999999.0}) {
            CAPTURE(limit);
            const Bracket bracket = search(range, limit).bracket;
            REQUIRE(bracket.holds.has_value());
            REQUIRE(bracket.fails.has_value());
            CHECK(*bracket.holds <= limit);
            CHECK(*bracket.fails > limit);
            CHECK(*bracket.fails <= 1.5001 * *bracket.holds);
            CHECK(bracket.reason == "too much at " + std::to_string(*bracket.fails));
            CHECK(!bracket.is_out_of_time);
        }
    }
    TEST_CASE("whole numbers are found to one, or to the ratio") {
        const Range range{.first = 5, .last = 1000, .stride = 2, .narrow = 1.0, .is_whole = true};
        for (const double limit : {5.0, 6.0, 7.0, 9.0, 10.0, 63.0, 64.0, 999.0}) {
            CAPTURE(limit);
            const Search found = search(range, limit);
            CHECK(found.bracket.holds == limit);
            CHECK(found.bracket.fails == limit + 1);
            for (const double value : found.tried) CHECK(value == static_cast<int>(value));
        }
    }
    TEST_CASE("differences count on a linear range, whose end is tried") {
        const Range range{.first = 0.1, .last = 0.88, .stride = 0.13, .narrow = 0.02, .is_linear = true};
        for (const double limit : {0.15, 0.5, 0.87}) {
            CAPTURE(limit);
            const Bracket bracket = search(range, limit).bracket;
            CHECK(*bracket.holds <= limit);
            CHECK(*bracket.fails > limit);
            CHECK(*bracket.fails - *bracket.holds < 0.0201);
        }
        const Search all = search(range, 1);
        CHECK(all.tried.back() == 0.88);
        CHECK(all.bracket.holds == 0.88);
        CHECK(!all.bracket.fails);
    }
    TEST_CASE("what fails at once has no bracket, and is tried once") {
        const Search found = search({.first = 10, .last = 1e9, .stride = 10}, 1);
        CHECK(!found.bracket.holds);
        CHECK(found.bracket.fails == 10);
        CHECK(found.tried == std::vector<double>{10});
    }
    TEST_CASE("what is out of time says so, with what was known") {
        const Range range{.first = 1, .last = 1e6, .stride = 10, .narrow = 1.01};
        const Bracket none = search(range, 500, 0).bracket;
        CHECK(none.is_out_of_time);
        CHECK(!none.holds);
        CHECK(!none.fails);
        const Bracket up = search(range, 500, 2).bracket;
        CHECK(up.is_out_of_time);
        CHECK(up.holds == 10);
        CHECK(!up.fails);
        const Bracket between = search(range, 500, 5).bracket;
        CHECK(between.is_out_of_time);
        CHECK(*between.holds <= 500);
        CHECK(*between.fails > 500);
    }
}

}  // namespace

}  // namespace test_brackets

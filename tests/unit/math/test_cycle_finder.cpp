// Iterations that go round in circles end where they would without leaving anything out.
#include "math/cycle_finder.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace test_cycle_finder {

using namespace carom;

namespace {

/// A state that goes from 0 to `tail` and then round by `period`.
struct Path {
    int tail, period;
    int after(int state) const { return state + 1 < tail + period ? state + 1 : tail; }
};

struct Ended {
    std::vector<int> state;
    int rounds = 0;  // that were carried out
};

Ended iterate(const Path& path, int rounds, bool skips) {
    CycleFinder<std::vector<int>> cycle;
    cycle.begin();
    Ended ended{.state = {0, 0}};
    for (int round = 0; round < rounds; ++round) {
        ended.state[1] = path.after(ended.state[1]);
        ++ended.rounds;
        if (skips) round = cycle.same_at(ended.state, round, rounds - 1);
    }
    return ended;
}

}  // namespace

TEST_SUITE("unit: cycle finder") {
    TEST_CASE("an iteration whose cycles are left out ends in the state that it would end in") {
        for (const int rounds : {1, 2, 52, 53, 200})
            for (const int tail : {1, 2, 5, 17})
                for (const int period : {1, 2, 3, 7, 300}) {
                    CAPTURE(rounds);
                    CAPTURE(tail);
                    CAPTURE(period);
                    const Ended all = iterate({tail, period}, rounds, false),
                                some = iterate({tail, period}, rounds, true);
                    CHECK(some.state == all.state);
                    CHECK(some.rounds <= all.rounds);
                }
    }

    TEST_CASE("a cycle is found within three times its beginning and length") {
        for (const int tail : {1, 2, 5, 17})
            for (const int period : {1, 2, 3, 7})
                CHECK(iterate({tail, period}, 10'000, true).rounds <= 3 * (tail + 2 * period) + 3);
    }

    TEST_CASE("states of before another rule are no cycle") {
        CycleFinder<std::vector<int>> cycle;
        cycle.begin();
        CHECK(cycle.same_at({1}, 0, 9) == 0);
        cycle.begin();
        CHECK(cycle.same_at({1}, 1, 9) == 1);
        CHECK(cycle.same_at({1}, 2, 9) == 9);
    }
}

}  // namespace test_cycle_finder

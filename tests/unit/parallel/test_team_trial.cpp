#include "parallel/team_trial.hpp"

#include <doctest/doctest.h>

namespace test_team_trial {

using carom::TeamTrial;

namespace {

/// Steps of a machine on which they take these times [s]. @return how many ran on threads
int run(TeamTrial& trial, int steps, double on_threads, double on_one) {
    int with_threads = 0;
    for (int i = 0; i < steps; ++i) {
        const bool uses_threads = trial.uses_threads();
        with_threads += uses_threads ? 1 : 0;
        // Every fifth step is disturbed by something else.
        trial.note((uses_threads ? on_threads : on_one) * (i % 5 == 0 ? 3 : 1));
    }
    return with_threads;
}

}  // namespace

TEST_SUITE("parallel/team_trial") {
    TEST_CASE("steps run on threads where that is shorter, else on one") {
        for (const double gain : {0.5, 0.9, 1.0, 1.02, 1.05, 1.5, 1.9}) {
            CAPTURE(gain);
            TeamTrial trial;
            CHECK(run(trial, TeamTrial::kSteps, 1 / gain, 1) == TeamTrial::kSteps / 2);
            const int after = run(trial, TeamTrial::kFewestStepsBetween, 1 / gain, 1);
            CHECK(after == (gain > TeamTrial::kLeastGain ? TeamTrial::kFewestStepsBetween : 0));
        }
    }

    TEST_CASE("what does not pay is tried again, ever less often, and may come to pay") {
        TeamTrial trial;
        CHECK(run(trial, 100'000, 2, 1) < 0.01 * 100'000);
        CHECK(run(trial, 4 * TeamTrial::kMostStepsBetween, 1, 2) > 2 * TeamTrial::kMostStepsBetween);
    }
}

}  // namespace test_team_trial

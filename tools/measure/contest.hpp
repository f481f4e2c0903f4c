#pragma once

#include <functional>
#include <string>
#include <vector>

namespace carom::measure {

/// Something that is timed beside others.
struct Contestant {
    std::string name;
    std::function<void()> step;
    bool threaded = false;  ///< uses other threads: timed on the wall instead of by processor time
    std::function<void()> before_turn{};  ///< if any: called before each turn, not timed
};

struct ContestOptions {
    int rounds = 5;                   ///< >= 1
    double seconds_of_a_turn = 0.02;  ///< a contestant's turn lasts at least that long
    int fewest_steps = 6;             ///< and that many steps: grids are built anew only every few
};

/// Seconds a step of every contestant, by contestant, then round. Contestants take turns, each round in
/// another order, so that what the machine does beside hits all alike: compare within a round.
std::vector<std::vector<double>> run_contest(const std::vector<Contestant>& contestants,
                                             const ContestOptions& options);

}  // namespace carom::measure

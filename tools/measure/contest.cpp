#include "measure/contest.hpp"

#include "measure/clocks.hpp"

namespace carom::measure {
namespace {

double now(const Contestant& contestant) {
    return contestant.threaded ? wall_seconds() : thread_seconds();
}

/// Seconds a step of one turn.
double take_turn(const Contestant& contestant, const ContestOptions& options) {
    if (contestant.before_turn) contestant.before_turn();
    const double start = now(contestant);
    double seconds = 0;
    int steps = 0;
    do {
        for (int i = 0; i < options.fewest_steps; ++i) contestant.step();
        steps += options.fewest_steps;
        seconds = now(contestant) - start;
    } while (seconds < options.seconds_of_a_turn);
    return seconds / steps;
}

}  // namespace

std::vector<std::vector<double>> run_contest(const std::vector<Contestant>& contestants,
                                             const ContestOptions& options) {
    const std::size_t count = contestants.size();
    std::vector<std::vector<double>> seconds(count);
    for (int round = 0; round < options.rounds; ++round)
        for (std::size_t turn = 0; turn < count; ++turn) {
            const std::size_t who = (turn + static_cast<std::size_t>(round)) % count;
            seconds[who].push_back(take_turn(contestants[who], options));
        }
    return seconds;
}

}  // namespace carom::measure

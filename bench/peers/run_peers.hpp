#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "measure/contest.hpp"
#include "measure/json.hpp"

namespace carom::bench {

/// A scene and how many bodies it has.
struct PeerTask {
    std::string scene;
    std::int64_t bodies = 0;
};

/// Every engine takes every scene from the same state: settles on its own, then all take turns. Times, the
/// ratio of each to ours round by round, and what `measure_bodies` says of each at the end.
/// @param options   seconds_of_a_turn is that of our engine; all take as many steps as it does then
/// @param progress  told what is about to run
/// @return a result file of the kind "peers"
measure::Json run_peers(const std::vector<PeerTask>& tasks, const measure::ContestOptions& options,
                        const std::function<void(const std::string&)>& progress);

/// A table of the same for a terminal.
std::string peers_text(const measure::Json& peers);

}  // namespace carom::bench

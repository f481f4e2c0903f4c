#pragma once

#include <functional>

#include "accuracy/results.hpp"

namespace carom::accuracy {

struct Effort {
    double seconds_a_point = 0.25;  ///< s, about: runs are repeated until then
    double longest_run = 2;         ///< s: then it has failed
    double long_run = 1;            ///< s: of all runs together, from which on no more are needed
    int most_runs = 15;
    int most_members = kEnsemble;
};

/// Runs a case in one setting, several times.
/// @param stop  asked between runs; if it says so the point is incomplete, and nothing is returned
std::optional<Point> measure(const Case& asked, const Setting& setting, const Effort& effort,
                             const std::function<bool()>& stop);

}  // namespace carom::accuracy

#pragma once

#include <string>

#include "measure/json.hpp"

namespace carom::bench {

/// Puts the runs of the kernels' benchmarks beside what this machine can do at most, which is measured here:
/// items, bytes and operations a second, share of the roof, and which roof; and how much faster than the
/// scalar kernel each is.
/// @param runs  as `CollectingReporter` keeps them
/// @return a result file of the kind "kernels"
measure::Json roofline_json(const measure::Json& runs);

/// A table of the same for a terminal.
std::string roofline_text(const measure::Json& roofline);

}  // namespace carom::bench

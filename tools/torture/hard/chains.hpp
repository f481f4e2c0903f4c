#pragma once

#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// Gap of the joints of `weighted_chain` and what its energy gains of the fall, in ten seconds.
Measures strain_of(HardRun& run, int links, double weight, double largest_gap, int steps);

}  // namespace carom::torture

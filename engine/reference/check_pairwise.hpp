#pragma once

#include <carom/pairwise.hpp>

namespace carom {

/// @throws Error naming the first setting or body that is wrong, its value, the limit and the remedy.
void check_pairwise(const PairwiseScene& scene);

/// @throws Error unless dt is finite and >= 0.
void check_pairwise_dt(double dt);

}  // namespace carom

#pragma once

#include <cmath>

namespace carom::torture {

/// Energy that a passive scene, one that nothing drives, may gain: a share of what it had at its start, far
/// above round-off. docs/hard-cases.md states the rule.
inline constexpr double kLargestRise = 1e-3;

/// Whether the rule is kept; potential energy may be 0 anywhere. @param energy, start  J
inline bool keeps_energy_rule(double energy, double start) {
    return energy <= start + kLargestRise * std::fabs(start);
}

}  // namespace carom::torture

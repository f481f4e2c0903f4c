#pragma once

#include <cmath>

namespace carom::torture {

/// Energy that a passive scene, one that nothing drives, may gain: a share of what it had at its start.
/// Whatever is right gains no more than round-off; the mark is that of docs/hard-cases.md.
inline constexpr double kLargestRise = 1e-3;

/// By how much the energy is above its start, as a share of the start; not above 0 where it is not.
/// @param scale  J, > 0: what the share is of
inline double rise_of(double energy, double start, double scale) {
    return (energy - start) / scale;
}

/// Whether the energy rule is kept where the zero of potential energy is anywhere.
inline bool keeps_energy_rule(double energy, double start) {
    return energy <= start + kLargestRise * std::fabs(start);
}

}  // namespace carom::torture

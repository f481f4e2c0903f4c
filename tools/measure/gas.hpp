#pragma once

#include <carom/carom.hpp>
#include <carom/pairwise.hpp>

#include <cstdint>
#include <string>

namespace carom::measure {

inline constexpr double kStep = 1.0 / 60;  // s, of all benchmark scenes

/// The elastic gas: discs of radius 0.5 m at a packing fraction of 0.40 in a closed square box, speeds of
/// 3 m/s root mean square, zero total momentum, restitution 1.
inline constexpr double kGasRadius = 0.5;    // m
inline constexpr double kGasPacking = 0.40;  // area of the discs / area of the box
inline constexpr double kGasSpeed = 3;       // m/s

/// The gas as its generator makes it, on a lattice. Cost: O(bodies).
Scene gas_scene(std::int64_t bodies);

/// The gas a second later: its start on a lattice is forgotten. Every contestant starts from there.
Scene flown_gas_scene(std::int64_t bodies);

/// The same for the naive loop over all pairs.
PairwiseScene pairwise_gas(const Scene& scene);

}  // namespace carom::measure

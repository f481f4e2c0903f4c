#pragma once

#include "state/bodies.hpp"

namespace carom {

/// One disc in so many may be smaller than the usual ones: docs/decisions/0021-usual-radius.md.
inline constexpr std::size_t kUsualShare = 16;

/// What the discs of a world have for radii [m]; zero where it has none. Bodies of segments and chains have
/// no radius: what their rows hold in its place means nothing.
struct Radii {
    double smallest = 0, largest = 0;
    /// The unit of what is one for all: at most one in kUsualShare of the discs that move is smaller, so that
    /// a few small ones among many large ones do not count. Where none moves, the smallest.
    double usual = 0;
};

/// The radii of all rows that are awake. Cost: O(bodies) where radii differ.
template <class Real>
Radii measure_radii(const Bodies<Real>& bodies);

extern template Radii measure_radii(const Bodies<float>&);
extern template Radii measure_radii(const Bodies<double>&);

}  // namespace carom

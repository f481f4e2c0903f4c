#pragma once

#include "state/bodies.hpp"

namespace carom {

/// One disc in so many may be smaller than the usual ones: docs/decisions/0021-usual-radius.md.
inline constexpr std::size_t kUsualShare = 16;

/// What the bodies of a world have for radii [m]; zero where it has none. Of a body that is no disc the
/// largest one is of the disc around it, the smallest of the disc in it. Not counted are bodies of segments
/// and chains, whose rows hold nothing that means a radius, and floors: what is no disc and does not move.
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

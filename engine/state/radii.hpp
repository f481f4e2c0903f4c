#pragma once

#include "state/bodies.hpp"

namespace carom {

/// What the discs of a world have for radii [m]; zero where it has none. Bodies of segments and chains have
/// no radius: what their rows hold in its place means nothing.
struct Radii {
    double smallest = 0, largest = 0;
};

/// The radii of all rows that are awake. Cost: O(bodies) where radii differ.
template <class Real>
Radii measure_radii(const Bodies<Real>& bodies);

extern template Radii measure_radii(const Bodies<float>&);
extern template Radii measure_radii(const Bodies<double>&);

}  // namespace carom

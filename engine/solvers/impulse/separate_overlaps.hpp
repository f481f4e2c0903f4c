#pragma once

#include <vector>

#include "effects/touching.hpp"
#include "solvers/impulse/impacts/flights.hpp"

namespace carom {

/// Gauss-Seidel sweeps over the overlaps, at most.
inline constexpr int kSeparationSweeps = 64;

/// Pushes overlapping pairs apart along their normals, by inverse mass, until only the slop is left or the
/// cap on the speed is reached; velocities are not touched. Gauss-Seidel, in the order of `overlaps`.
/// @return how many meetings were pushed. Work done against gravity goes into the books as correction.
template <class Real>
int separate_overlaps(Flights<Real>& flights, const std::vector<Meeting>& overlaps, double dt,
                      std::vector<double>& targets);

extern template int separate_overlaps(Flights<float>&, const std::vector<Meeting>&, double,
                                      std::vector<double>&);
extern template int separate_overlaps(Flights<double>&, const std::vector<Meeting>&, double,
                                      std::vector<double>&);

}  // namespace carom

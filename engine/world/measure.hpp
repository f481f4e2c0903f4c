#pragma once

#include <carom/world.hpp>

#include "solvers/shared/simulation.hpp"

// Questions about a simulation that are not part of a step.

namespace carom {

/// Overlaps of all pairs and at the walls, from the positions in the columns; leaves the simulation as it is.
template <class Real>
OverlapReport measure_overlaps(Simulation<Real>& sim);

}  // namespace carom

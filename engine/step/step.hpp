#pragma once

#include "step/plan.hpp"
#include "step/stage_times.hpp"

namespace carom {

/// Advances a simulation by dt [s], > 0 and within the limits.
template <class Real>
void step(Simulation<Real>& sim, double dt, StageTimes& times);

extern template void step(Simulation<float>&, double, StageTimes&);
extern template void step(Simulation<double>&, double, StageTimes&);

}  // namespace carom

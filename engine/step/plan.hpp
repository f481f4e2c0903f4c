#pragma once

#include "scene/call_effects.hpp"
#include "solvers/shared/simulation.hpp"

namespace carom {

/// The plan in words, for `World::plan()`: what runs and why.
template <class Real>
Plan describe_plan(Simulation<Real>& sim, const CalledEffects& called);

extern template Plan describe_plan(Simulation<float>&, const CalledEffects&);
extern template Plan describe_plan(Simulation<double>&, const CalledEffects&);

}  // namespace carom

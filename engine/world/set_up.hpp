#pragma once

#include <carom/world.hpp>

#include "solvers/shared/simulation.hpp"

namespace carom {

/// How accurately a world of this scene is to be solved; the solver is never automatic here.
Accuracy accuracy_of(const Scene& scene, const WorldOptions& options);

/// Fills a simulation that was just made (step/make_simulation.hpp) as a world needs it: kernels, threads,
/// substeps, iterations, and columns of the scene's bodies.
/// @param scene, options  valid together
/// @param effects  that the scene calls for (scene/call_effects.hpp)
/// Cost: O(bodies).
template <class Real>
void set_up(Simulation<Real>& sim, const Scene& scene, const WorldOptions& options, const Effects& effects);

/// A joint of bodies of this world where they stand now. @param joint  that has been validated
template <class Real>
StoredJoint joint_of(const WorldState<Real>& world, const Joint& joint);

extern template StoredJoint joint_of(const WorldState<float>&, const Joint&);
extern template StoredJoint joint_of(const WorldState<double>&, const Joint&);
extern template void set_up(Simulation<float>&, const Scene&, const WorldOptions&, const Effects&);
extern template void set_up(Simulation<double>&, const Scene&, const WorldOptions&, const Effects&);

}  // namespace carom

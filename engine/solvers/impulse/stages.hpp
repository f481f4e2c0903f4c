#pragma once

#include "solvers/impulse/impulse_simulation.hpp"

// The stages of solver `impulse`: step/impulse_step.cpp has their order and what they touch,
// and calls the simpler ones itself.

namespace carom {

/// Packs every body's motion and lists bodies near walls, out of their margin, or out of the limits.
template <class Real>
void begin_flight(ImpulseSimulation<Real>& sim);

/// Lists the few meetings that can happen in this substep.
template <class Real>
void find_impacts(ImpulseSimulation<Real>& sim);

/// Writes what gravity and drag did into the books.
template <class Real>
void keep_books(ImpulseSimulation<Real>& sim);

/// Turns bodies.
template <class Real>
void advance_rotation(ImpulseSimulation<Real>& sim);

/// Writes positions and velocities back.
template <class Real>
void end_flight(ImpulseSimulation<Real>& sim);

}  // namespace carom

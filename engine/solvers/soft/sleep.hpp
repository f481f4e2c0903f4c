#pragma once

#include "solvers/shared/simulation.hpp"

namespace carom {

// Calls from outside of a step that wake sleepers. Without the effect they do nothing.

/// Wakes the islands of all sleepers that a disc of radius `reach` at `place` touches.
template <class Real>
void wake_at(Simulation<Real>& sim, Vec2 place, double reach);

/// Wakes everybody: segments and chains may touch anything.
template <class Real>
void wake_all(Simulation<Real>& sim);

/// Wakes the island of a row, if it sleeps. @return the row it has then
template <class Real>
std::size_t wake_body(Simulation<Real>& sim, std::size_t row);

}  // namespace carom

#pragma once

#include <carom/ledger.hpp>
#include <carom/profile.hpp>

#include "solvers/shared/simulation.hpp"

// What a world says of itself.

namespace carom {

/// Energy and momentum now; by cause if the ledger effect is on. Cost: O(bodies).
template <class Real>
Ledger ledger_of(const WorldState<Real>& world);

/// Adds what a simulation has counted and how long its stages took.
template <class Real>
void add_counts(const Simulation<Real>& sim, Profile& profile);

extern template Ledger ledger_of(const WorldState<float>&);
extern template Ledger ledger_of(const WorldState<double>&);
extern template void add_counts(const Simulation<float>&, Profile&);
extern template void add_counts(const Simulation<double>&, Profile&);

}  // namespace carom

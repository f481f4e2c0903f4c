#pragma once

#include "state/world_state.hpp"

namespace carom {

/// Which rules a solver keeps in a world: debug builds assert them, that of passive worlds as far as the
/// energy rule of docs/hard-cases.md goes, a thousandth. Where it does not, excess is noted alone.
struct KeptEnergyRules {
    bool restitution = false, correction = false, passive = false;
};

/// Checks behind a step what holds by construction, and notes the largest excess of each rule (EnergyExcess).
///
/// *Restitution gives no energy*: what the books have of it does not rise in a step.
///
/// *Pushes add no more than the overlap that they find is worth*. By virtual work the forces F of contacts
/// that hold bodies still against gravity do F δ in sum, along whatever small ways δ the surfaces are moved
/// apart, where the weights do -F δ: so to part surfaces by the overlap δ lifts what they carry by F δ, all
/// that lies on them included. Two that press on nothing yet weigh with their effective mass m: m |g| δ. The
/// solvers sum (F + m |g|) δ over the overlaps that they find (Books::overlap_worth). Overlap that comes
/// about within the step has cost bodies F δ that contacts took.
///
/// *A passive world has no more energy than at its start*, or than a call or the last step that was not
/// passive has left it with; and what the overlaps are worth that it begins with then. Passive is a world
/// without motors, targets, springs, limits that move and kinematic bodies that do, and in whose step no
/// joint breaks. Where the solver begins to keep the rule, as when the last joint is gone, it starts anew.
///
/// Each may be exceeded by rounding: a velocity is rounded kRoundings times a substep, each time by half the
/// distance to the next number of the world's precision, which changes an energy by twice that share of it.
/// All roundings of an energy count as if they had one sign. Cost: 2 ns a body.
template <class Real>
void check_energy(WorldState<Real>& world, int substeps, const KeptEnergyRules& kept);

extern template void check_energy(WorldState<float>&, int, const KeptEnergyRules&);
extern template void check_energy(WorldState<double>&, int, const KeptEnergyRules&);

}  // namespace carom

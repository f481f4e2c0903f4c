#pragma once

#include "state/world_state.hpp"

namespace carom {

/// Bodies of a mechanism that overlap as it is built: every other link of a chain of discs that are nearer to
/// each other than their radius, two thighs side by side. Joints hold them where contacts do not want them.
/// No state satisfies both, so each step of one would undo what the other did, and springs and friction would
/// turn that into motion for ever. The joints are what the user placed, so such a pair does not touch
/// until it has come apart, as a pair does not that a joint joins.
///
/// A mechanism is what joints connect, up to bodies that nothing moves; these count where a third body is
/// joined to both of the pair. What is directly joined by a joint that lets it touch is left as asked for.
///
/// Finds the pairs of mechanisms that joints were added to, and lets those touch that are apart now.
/// @return whether some pair is to touch now, or no more
/// Cost: about 4 ns for each pair that is listed, .1 us if only their outer circles overlap; O(bodies +
/// joints) after joints were added, and a look at each pair of their mechanisms whose circles overlap.
/// docs/decisions/0070-bodies-built-into-each-other.md.
template <class Real>
bool watch_built_in_pairs(WorldState<Real>& world);

}  // namespace carom

#pragma once

#include "scenes/scenes.hpp"

// Scenes of joints; scenes.hpp names them.

namespace carom::bench {

/// A square net of small discs on rods that hangs by its two upper corners, from the moment at which it is
/// let go. `bodies` is rounded down to a square.
BenchScene net(std::int64_t bodies);

/// Ragdolls of eleven bodies and ten hinges with limits, dropped into an open box; `bodies` is rounded down
/// to whole ones.
BenchScene ragdolls(std::int64_t bodies);

/// A car of a body and two wheels that motors turn, on a rough track of chain edges, along which crates lie;
/// `bodies` counts the track, too.
BenchScene car(std::int64_t bodies);

/// A chain of twenty links that falls to the floor, and boxes, capsules and discs that fall on it.
BenchScene chain(std::int64_t bodies);

/// A ragdoll of eleven bodies that falls down stairs of chain edges, on which crates, capsules and discs lie;
/// `bodies` counts these, too.
BenchScene stairs(std::int64_t bodies);

}  // namespace carom::bench

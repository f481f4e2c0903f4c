#pragma once

#include "scenes/scenes.hpp"

// Scenes that a motor on a hinge keeps moving; scenes.hpp names them.

namespace carom::bench {

/// A hollow square that a motor turns, with small boxes tumbling in it.
BenchScene driven_drum(std::int64_t bodies);

/// A bar that a motor turns in a round vessel of discs, capsules and boxes, which bounce.
BenchScene spinner(std::int64_t bodies);

}  // namespace carom::bench

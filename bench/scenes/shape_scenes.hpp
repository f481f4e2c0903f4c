#pragma once

#include "scenes/scenes.hpp"

// Scenes of boxes and other shapes; scenes.hpp names them.

namespace carom::bench {

/// Unit boxes, touching, as many rows from the bottom as it takes; base 100 for 5,050 bodies. Calm by the
/// time it is timed.
BenchScene pyramid(std::int64_t bodies);

/// Boxes of random sides and angles dropped from a loose grid into an open box.
BenchScene box_pile(std::int64_t bodies);

/// The same of discs, boxes, capsules and polygons of three to eight vertices, a quarter each.
BenchScene mixed_pile(std::int64_t bodies);

/// A heavy box, the first body, flies into a wall of unit boxes twice as high as it is wide.
BenchScene smash(std::int64_t bodies);

/// Planks a hundred times longer than thick, dropped flat into an open box that is wide enough for three.
BenchScene planks(std::int64_t bodies);

/// The first steps of a scene, over and over, before it has settled. Its name ends with "-start".
BenchScene start_of(BenchScene scene, int steps);

}  // namespace carom::bench

#pragma once

#include <carom/scene.hpp>

#include "torture/hard/hard_case.hpp"

namespace carom::torture {

/// Small discs on and beside one that is `ratio` times as large, in a closed box.
Scene small_around_large(double ratio);
/// Their overlaps, with the large one, each other and the walls, in their radii.
Measures overlap_around_large(HardRun& run, int steps);

}  // namespace carom::torture

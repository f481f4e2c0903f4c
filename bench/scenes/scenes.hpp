#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "peers/bench_scene.hpp"

namespace carom::bench {

/// The kinds there are: "gas", "rough-gas", "pile", "packed", "tumbler" of discs; "pyramid", "box-pile",
/// "mixed-pile", "smash", "planks" of other shapes, all but "smash" with "-start", too; "driven-drum" and
/// "spinner", which motors keep moving; "net" and "ragdolls" of joints; "car", "chain" and "stairs" of a
/// single mechanism among some tens of shapes.
const std::vector<std::string>& scene_names();

/// @param name    one of `scene_names`
/// @param bodies  >= 1
/// Cost: O(bodies).
BenchScene make_scene(const std::string& name, std::int64_t bodies);

}  // namespace carom::bench

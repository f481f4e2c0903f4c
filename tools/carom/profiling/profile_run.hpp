#pragma once

#include <carom/scene.hpp>

#include <string>

#include "measure/json.hpp"
#include "profiling/trace.hpp"
#include "simulation/simulation.hpp"

namespace carom::tool {

/// Steps a scene as often as it says with the instruction set asked for, and beside it, in turns, with scalar
/// kernels, which take the same steps bit for bit, and on one thread with the loops watched that threads
/// share. Says of each stage what it took, how much it did, what share of the machine's ceilings that is, and
/// what limits it; of the whole step what one thread has to itself, and what more cores allow.
/// @param trace  gets the times of every step if it is not null
/// @return a result file of the kind "profile"
/// @throws UsageError if the scene takes no steps
measure::Json profile_scene(const Scene& scene, const MachineSettings& machine, Trace* trace);

/// A table of the same for a terminal.
std::string profile_text(const measure::Json& profile);

}  // namespace carom::tool

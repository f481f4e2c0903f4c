#pragma once

#include <carom/scene.hpp>

#include <filesystem>

#include "simulation/simulation.hpp"

namespace carom::tool {

/// Writes the state of every body, in scene order, with digits that read back as the same numbers.
/// @throws WriteError
void write_final_csv(const std::filesystem::path& path, const Scene& scene, const Simulation& simulation);

}  // namespace carom::tool

#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <optional>
#include <string>

#include "simulation/simulation.hpp"

namespace CLI {
class App;
}

namespace carom::tool {

/// What the command line says over the scene; what is left out stays as the scene has it.
struct RunSettings {
    std::optional<std::int64_t> steps;
    std::optional<double> dt;  // s
    std::optional<Solver> solver;
    std::optional<int> substeps;
    std::optional<int> iterations;
    std::optional<Precision> precision;
    EffectOverrides effects;
    MachineSettings machine;
};

/// Adds --steps, --dt, --solver, --substeps, --iterations, --precision, --effects, --isa, --threads.
void add_settings_options(CLI::App& command, RunSettings& settings);

/// Puts the settings into the scene, and the ledger on unless scene or settings say otherwise.
/// @throws UsageError for a precision the solver does not have
void apply_settings(const RunSettings& settings, Scene& scene);

/// A scene as a world of one's own would run it, to be measured: without a ledger unless it is asked for, and
/// with the file's name if it has none. @throws as read_scene and apply_settings
Scene read_measured_scene(const std::string& file, const RunSettings& settings);

}  // namespace carom::tool

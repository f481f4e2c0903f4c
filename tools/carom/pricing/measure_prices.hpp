#pragma once

#include <carom/scene.hpp>

#include "measure/json.hpp"
#include "simulation/simulation.hpp"

namespace carom::tool {

struct PriceOptions {
    MachineSettings machine{};
    int repeats = 11;  ///< pairs of turns an effect, >= 1
};

/// Runs the scene for as many steps as it says, then measures from the state it has reached what each effect
/// of priced_effects() costs: docs/effects.md says how.
/// @return a result file of the kind "prices", of the effects that were done when the run was interrupted
/// @throws UsageError for the naive engine, which has no effect that can be left out
measure::Json measure_prices(const Scene& scene, const PriceOptions& options);

/// A table of the same for a terminal.
std::string prices_text(const measure::Json& prices);

}  // namespace carom::tool

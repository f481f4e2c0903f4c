#pragma once

#include <carom/scene.hpp>

#include <string>

#include "results/run_outcome.hpp"
#include "simulation/simulation.hpp"

namespace carom::tool {

/// What a run prints when it is over: energy and momentum first and last, contacts, the ledger, time.
std::string summary_table(const RunOutcome& outcome);

/// The final state of the first bodies.
std::string body_table(const Scene& scene, const Simulation& simulation);

}  // namespace carom::tool

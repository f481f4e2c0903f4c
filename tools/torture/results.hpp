#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "torture/case.hpp"

namespace carom::torture {

using Json = nlohmann::ordered_json;

Json to_json(const Outcome& outcome);
/// @throws nlohmann::json::exception if it is not as `to_json` writes it
Outcome outcome_from(const Json& json);

/// Everything: a row a scene and solver, and how many of each case pass.
Json to_json(std::span<const Case* const> cases, std::span<const Row> rows, const Options& asked);

}  // namespace carom::torture

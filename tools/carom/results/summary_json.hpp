#pragma once

#include <filesystem>

#include <nlohmann/json.hpp>

#include "results/run_outcome.hpp"

namespace carom::tool {

/// The summary as docs/results.md describes it.
nlohmann::ordered_json summary_of(const RunOutcome& outcome);

/// @throws WriteError
void write_summary_json(const std::filesystem::path& path, const RunOutcome& outcome);

/// 16 hex digits.
std::string hash_text(std::uint64_t hash);

}  // namespace carom::tool

#pragma once

#include <carom/profile.hpp>

#include <nlohmann/json.hpp>

namespace carom::tool {

/// What runs and why: `carom explain --json` and "plan" of summary.json.
nlohmann::ordered_json plan_json(const Plan& plan);

}  // namespace carom::tool

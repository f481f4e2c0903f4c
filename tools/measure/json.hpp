#pragma once

#include <nlohmann/json.hpp>

namespace carom::measure {

using Json = nlohmann::ordered_json;

}  // namespace carom::measure

#pragma once

#include "scene_file/scene_reader.hpp"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

namespace carom::tool {

/// The JSON document in a text. Stricter than the standard asks: keys of an object are unique, nesting and
/// the number of values are limited, and numbers are finite.
/// @throws SceneFileError saying line and column, the pointer reached, and what to do about common mistakes.
nlohmann::json parse_json(std::string_view text, std::string_view file, const SceneFileLimits& limits);

}  // namespace carom::tool

#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace carom::measure {

using Json = nlohmann::ordered_json;

/// A result file's text: one line a member, and one line for each element of an array of objects, so that
/// files stay short and two of them can be compared line by line.
std::string result_text(const Json& result);

}  // namespace carom::measure

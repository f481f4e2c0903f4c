#pragma once

#include <iosfwd>
#include <string_view>

#include "report/page/markup.hpp"

namespace carom::report {

/// Arrays and objects within each other that a result file may have. Writing JSON goes down into them, a
/// thousand deep at the cost of some 100 kB of stack; what the program writes is 6 deep.
inline constexpr int kDeepestJson = 64;

/// @throws Json::parse_error if it is no JSON, Json::out_of_range if it is nested more than kDeepestJson deep
Json parse_json(std::istream& text);
Json parse_json(std::string_view text);

}  // namespace carom::report

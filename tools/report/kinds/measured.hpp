#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "report/kinds/kinds.hpp"

// What the pages of measurements share.

namespace carom::report {

/// What tells results apart that are drawn together: nothing if there is one, else " (A)", " (B)", ...
std::string tag_of(const std::vector<Result>& results, std::size_t index);

/// Says of each result which file it is, when and on what machine it was measured, and with what.
void add_origins(const std::vector<Result>& results, Page& page);

/// The number with that many digits.
std::string digits(double value, int significant = 4);

/// A point with the error bar of {"median", "low", "high"}, all times `scale`.
Point spread_point(double x, const Json& spread, double scale = 1);

/// The parts of a name between slashes.
std::vector<std::string> name_parts(const std::string& name);

/// The value of the part "key:value" of a name as a number; 0 if there is none.
double name_value(const std::string& name, std::string_view key);

/// The series of that name, which is appended if there is none yet.
Series& series_named(std::vector<Series>& series, const std::string& name);

}  // namespace carom::report

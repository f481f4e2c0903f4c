#pragma once

#include <functional>

#include "torture/outcome.hpp"

namespace carom::torture {

/// What gets harder, from the easiest to the hardest, and how finely it is looked at.
struct Range {
    double first = 1, last = 1;
    double stride = 2;       ///< from one to the next on the way up: a factor
    double narrow = 1.1;     ///< a bracket whose ends have at most this ratio is narrow
    bool is_whole = false;   ///< whole numbers alone
    bool is_linear = false;  ///< stride and `narrow` are differences
};

enum class Verdict { holds, fails, out_of_time };

/// Goes up until something fails, then halves the bracket until it is narrow. What holds again above the
/// first that failed is not looked for.
/// @param probe  tries one value; it may say why it failed
/// @param report  called whenever more is known
Bracket bracket_of(const Range& range, const std::function<Verdict(double value, std::string& why)>& probe,
                   const std::function<void(const Bracket&)>& report);

}  // namespace carom::torture

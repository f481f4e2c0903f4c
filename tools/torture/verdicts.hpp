#pragma once

#include <string>

#include "torture/outcome.hpp"

namespace carom::torture {

/// The one measure that a cell shows: of those that fail the one farthest beyond its mark; else the first,
/// which is what the case is about. Null if there is none.
const Measure* shown_of(const Outcome& outcome);

/// "1.2e-3 (at most 1e-3)"
std::string words_of(const Measure& measure);

/// "holds at 40, fails at 44"
std::string words_of(const Bracket& bracket);

/// Why it fails, in words: why it did not end, and what is beyond its mark.
std::string reason_of(const Outcome& outcome);

}  // namespace carom::torture

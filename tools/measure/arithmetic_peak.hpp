#pragma once

#include <string>

namespace carom::measure {

/// Additions and multiplications a second of one core with vectors as wide as that instruction set's, in
/// single or double precision: many independent chains, so that only the arithmetic units limit them.
/// @param isa  "scalar", "sse2", "avx2", "avx512"; others count as scalar
double best_arithmetic_rate(const std::string& isa, bool is_double, double seconds);

}  // namespace carom::measure

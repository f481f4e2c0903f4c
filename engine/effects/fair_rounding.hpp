#pragma once

#include <cstdint>
#include <limits>

// Gravity adds to a speed in each step the same small number, small beside the speed. Rounded to the nearest
// number the sum is rounded the same way every time, and gravity is wrong by as much as half a unit in
// the last place a step: 5e-5 of it at 10 m/s, 1/1000 s and single precision. With a number added before that
// is spread evenly over a unit, up and down come in the right proportion ("dither"). The numbers are
// multiples of the golden ratio, which fill the unit more evenly than chance: the error does not grow with
// the root of the number of steps either. They depend on the number of the step alone, so a body's bits
// depend on no other's.

namespace carom {

/// The number to add in the n-th step before rounding, in units in the last place: in [-1/2, 1/2).
inline double dither(std::uint64_t n) {
    constexpr std::uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;  // times 2^64, modulo 1
    return static_cast<double>(static_cast<std::int64_t>(n * kGoldenRatio) >> 11) * 0x1p-53;
}

/// The same as a factor to the power of two below the size of the number.
template <class Real>
Real dither_factor(std::uint64_t n) {
    return static_cast<Real>(dither(n)) * std::numeric_limits<Real>::epsilon();
}

}  // namespace carom

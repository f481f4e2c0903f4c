#pragma once

#include <cmath>

#include "math/rotation.hpp"

namespace carom {

inline constexpr double kPi = 3.14159265358979323846;

/// The angle of a turn [rad], in (-π, π]; the inverse of rotation_by there, within 1e-15.
/// @param turn  of length 1 to rounding
///
/// Halving the angle three times leaves a tangent of at most tan(π/16): the first term of atan's series that
/// is left out, x^25 / 25, is then below 2^-57 x.
inline double angle_of(Rotation turn) {
    if (turn.sin == 0) return turn.cos < 0 ? kPi : 0;
    // tan(a / 2) = sin / (1 + cos); beyond a quarter turn the angle is taken from the other end, where
    // 1 + cos would cancel.
    const bool is_wide = turn.cos < 0;
    const double size = turn.sin < 0 ? -turn.sin : turn.sin;
    double tangent = size / (1 + (is_wide ? -turn.cos : turn.cos));  // of a half, <= 1
    tangent /= 1 + std::sqrt(1 + tangent * tangent);                 // of a quarter
    tangent /= 1 + std::sqrt(1 + tangent * tangent);                 // of an eighth, <= tan(π/16)
    const double square = tangent * tangent;
    double series = 0;
    for (int n = 23; n >= 1; n -= 2) series = 1.0 / n - square * series;
    const double acute = 8 * tangent * series;
    const double angle = is_wide ? kPi - acute : acute;
    return turn.sin < 0 ? -angle : angle;
}

}  // namespace carom

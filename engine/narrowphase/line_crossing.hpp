#pragma once

#include "math/vec2_math.hpp"

namespace carom {

/// When a point that moves straight from p to q crosses the line from a to b, as a share of its way; 2 if it
/// does not.
inline double time_of_crossing(Vec2 p, Vec2 q, Vec2 a, Vec2 b) {
    const Vec2 along = b - a;
    const double before = cross(along, p - a), after = cross(along, q - a);
    if (!((before < 0 && after > 0) || (before > 0 && after < 0))) return 2;
    const double time = before / (before - after), place = dot(p + time * (q - p) - a, along);
    return place >= 0 && place <= length_squared(along) ? time : 2;
}

}  // namespace carom

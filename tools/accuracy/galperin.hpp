#pragma once

#include <cstdint>

namespace carom::accuracy {

/// Galperin's billiard: a wall at the left, a resting disc of 1 kg, one of `ratio` kg that comes from the
/// right at -1 m/s; all elastic.
/// @return the heavy disc's velocity after so many collisions, impact by impact [m/s]
inline double galperin_velocity(double ratio, std::int64_t collisions) {
    long double light = 0, heavy = -1;
    for (std::int64_t i = 0; i < collisions; ++i) {
        if (i % 2 == 1) {
            light = -light;  // the wall
            continue;
        }
        const long double mean = (light + ratio * heavy) / (1 + ratio);
        light = 2 * mean - light, heavy = 2 * mean - heavy;
    }
    return static_cast<double>(heavy);
}

}  // namespace carom::accuracy

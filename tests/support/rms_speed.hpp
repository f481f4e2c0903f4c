#pragma once

#include <carom/world.hpp>

#include <cmath>
#include <cstddef>

namespace carom::test {

/// Root mean square speed of all bodies [m/s].
template <class Real>
double rms_speed(const BasicWorld<Real>& world) {
    const auto bodies = world.bodies();
    double sum = 0;
    for (std::size_t i = 0; i < bodies.count; ++i) {
        const auto x = static_cast<double>(bodies.velocity_x[i]),
                   y = static_cast<double>(bodies.velocity_y[i]);
        sum += x * x + y * y;
    }
    return std::sqrt(sum / static_cast<double>(bodies.count));
}

}  // namespace carom::test

#include "state/radii.hpp"

#include <cmath>

namespace carom {

template <class Real>
Radii measure_radii(const Bodies<Real>& bodies) {
    Radii radii;
    bool any = false;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        if (bodies.flags_of(row) & kEdges) continue;
        const double radius = bodies.radius[row];
        radii.smallest = any ? std::fmin(radii.smallest, radius) : radius;
        radii.largest = std::fmax(radii.largest, radius);
        any = true;
        if (bodies.radius.is_uniform()) break;
    }
    return radii;
}

template Radii measure_radii(const Bodies<float>&);
template Radii measure_radii(const Bodies<double>&);

}  // namespace carom

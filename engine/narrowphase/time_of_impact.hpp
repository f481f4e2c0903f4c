#pragma once

#include "simd/scalar_lanes.hpp"

namespace carom {
namespace {

/// When two discs in straight relative motion touch: |d + v t| = reach, a quadratic in t. Over lanes too, so
/// with internal linkage.
template <class F>
struct DiscApproach {
    F squared_speed;  // v², m²/s²
    F approach;       // d · v, m²/s; they approach where it is negative
    F gap;            // d² - reach², m²; negative where they overlap

    /// @param dx, dy  m, relative position at t = 0. @param vx, vy  m/s, relative velocity
    DiscApproach(F dx, F dy, F vx, F vy, F reach)
        : squared_speed(vx * vx + vy * vy),
          approach(dx * vx + dy * vy),
          gap(dx * dx + dy * dy - reach * reach) {}

    /// Positive where the lines come nearer than `reach`.
    F discriminant() const { return approach * approach - squared_speed * gap; }
    /// The smaller root [s], from the larger one, so that nothing cancels.
    /// @param discriminant  not negative
    F time_of_impact(F discriminant) const {
        using simd::sqrt;
        return gap / (sqrt(discriminant) - approach);
    }
    F time_of_least_distance() const { return -approach / squared_speed; }
};

}  // namespace
}  // namespace carom

#pragma once

#include "simd/scalar_lanes.hpp"

namespace carom {

/// A rectangle in the plane: a number or a batch each.
template <class F>
struct Rectangle {
    F x, y;            // m, its centre
    F cos, sin;        // of its angle
    F half_x, half_y;  // m, along its own axes
};

/// The largest of the gaps between two rectangles along the sides of both [m]; not positive where they
/// overlap. They are at least as far apart as that, and may be farther.
template <class F>
[[gnu::always_inline]] inline F rectangle_gap(const Rectangle<F>& a, const Rectangle<F>& b) {
    using simd::abs, simd::max;
    const F x = b.x - a.x, y = b.y - a.y;
    const F c = abs(a.cos * b.cos + a.sin * b.sin), s = abs(a.cos * b.sin - a.sin * b.cos);
    const F of_a = max(abs(a.cos * x + a.sin * y) - a.half_x - (b.half_x * c + b.half_y * s),
                       abs(a.cos * y - a.sin * x) - a.half_y - (b.half_x * s + b.half_y * c));
    const F of_b = max(abs(b.cos * x + b.sin * y) - b.half_x - (a.half_x * c + a.half_y * s),
                       abs(b.cos * y - b.sin * x) - b.half_y - (a.half_x * s + a.half_y * c));
    return max(of_a, of_b);
}

}  // namespace carom

#pragma once

#include "narrowphase/convex.hpp"

namespace carom {
namespace {

/// Whether a shape is a rectangle about the origin with sides along the axes and sharp corners, whichever
/// corner is the first.
template <class Real>
inline bool is_box(const ConvexShape<Real>& shape) {
    bool is = shape.count == 4 && shape.radius == 0;
    for (int i = 1; i < 4; ++i)
        is = is && simd::abs(shape.x[i]) == simd::abs(shape.x[0]) &&
             simd::abs(shape.y[i]) == simd::abs(shape.y[0]);
    return is;
}

/// Two boxes in the frame of a.
template <class F>
struct BoxPair {
    F cosine, sine;      // of the angle from a to b
    F b_x, b_y;          // m, the centre of b
    F half_ax, half_ay;  // m, half the sides of a, along its own axes
    F half_bx, half_by;  // m, of b
};

/// What find_face() tells of convex shapes: the frame of either box has all it needs as sums of half sides.
template <class Real, class F>
[[gnu::always_inline]] inline void find_face(const BoxPair<F>& pair, FacedPair<F>& found) {
    using simd::abs, simd::max, simd::min, simd::select;
    const F zero(Real(0)), one(Real(1));
    const F cosine = pair.cosine, sine = pair.sine, c = abs(cosine), s = abs(sine);
    const auto sign = [&](F value) { return select(value < zero, -one, one); };

    // Separations along the axes of a, then of b; each from where it sees the other's centre.
    const F ax = pair.b_x, ay = pair.b_y;
    const F bx = cosine * ax + sine * ay, by = cosine * ay - sine * ax;
    const F of_ax = abs(ax) - pair.half_ax - (pair.half_bx * c + pair.half_by * s);
    const F of_ay = abs(ay) - pair.half_ay - (pair.half_bx * s + pair.half_by * c);
    const F of_bx = abs(bx) - pair.half_bx - (pair.half_ax * c + pair.half_ay * s);
    const F of_by = abs(by) - pair.half_by - (pair.half_ax * s + pair.half_ay * c);
    const auto a_is_y = of_ay > of_ax, b_is_y = of_by > of_bx;

    // Outward normals: in the frame of a, and of b in both frames.
    const F sign_a = sign(select(a_is_y, ay, ax)), sign_b = -sign(select(b_is_y, by, bx));
    const F turned_x = sign_b * select(b_is_y, -sine, cosine);
    const F turned_y = sign_b * select(b_is_y, cosine, sine);
    const F size = min(min(pair.half_ax, pair.half_ay), min(pair.half_bx, pair.half_by));
    const auto swapped = b_has_reference<Real>(select(a_is_y, of_ay, of_ax), select(b_is_y, of_by, of_bx),
                                               sign_a * select(a_is_y, turned_y, turned_x), size);

    // From here on in the frame of the box that has the reference.
    const auto is_y = (swapped & b_is_y) | ((!swapped) & a_is_y);
    const F side = select(swapped, -one, one);
    const F half_x = select(swapped, pair.half_bx, pair.half_ax);
    const F half_y = select(swapped, pair.half_by, pair.half_ay);
    const F height = select(is_y, half_y, half_x), half = select(is_y, half_x, half_y);
    const F other_x = select(swapped, bx, ax), other_y = select(swapped, by, ay);
    const F normal = select(swapped, sign_b, sign_a);  // along the axis that is_y says
    const F centre_above = select(is_y, abs(other_y), abs(other_x));
    const F centre_along = side * normal * select(is_y, -other_x, other_y);

    // The side of the other box that faces the reference, by the angle between the boxes less whole quarters
    // of a turn: its cosine is the greater one.
    const auto turned_little = c > s;
    const F facing_above = -max(c, s);
    const F facing_along = -side * select(turned_little, sign(cosine) * sine, -sign(sine) * cosine);
    const auto faces_x = (is_y & (!turned_little)) | ((!is_y) & turned_little);
    const F other_half_x = select(swapped, pair.half_ax, pair.half_bx);
    const F other_half_y = select(swapped, pair.half_ay, pair.half_by);
    const F depth = select(faces_x, other_half_x, other_half_y);
    const F width = select(faces_x, other_half_y, other_half_x);
    const F middle_above = centre_above + depth * facing_above - height;
    const F middle_along = centre_along + depth * facing_along;
    const F rise = width * facing_along, reach = width * facing_above;

    found.view = {.from = -half,
                  .to = half,
                  .low_along = middle_along + reach,
                  .low_above = middle_above - rise,
                  .high_along = middle_along - reach,
                  .high_above = middle_above + rise,
                  .height = height,
                  .centre_along = centre_along,
                  .centre_above = centre_above,
                  .radius = zero,
                  .other_radius = zero,
                  .size = size};
    const F ax_normal = select(a_is_y, zero, sign_a), ay_normal = select(a_is_y, sign_a, zero);
    found.normal_x = select(swapped, turned_x, ax_normal);
    found.normal_y = select(swapped, turned_y, ay_normal);
    found.side = side;
}

}  // namespace
}  // namespace carom

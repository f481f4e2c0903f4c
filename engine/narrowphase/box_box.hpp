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

/// Where two boxes touch, as find_manifold() tells it, which also says what the terms are: the frame of
/// either box has all it needs as sums of its half sides.
template <class Real, class F>
[[gnu::always_inline]] inline Manifold<F> find_box_manifold(const BoxPair<F>& pair) {
    using simd::abs, simd::min, simd::select;
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

    // Outward normals, each in the frame of its own box; then that of b in the frame of a.
    const F nax = select(a_is_y, zero, sign(ax)), nay = select(a_is_y, sign(ay), zero);
    const F nbx = select(b_is_y, zero, -sign(bx)), nby = select(b_is_y, -sign(by), zero);
    const F turned_x = cosine * nbx - sine * nby, turned_y = sine * nbx + cosine * nby;
    const F size = min(min(pair.half_ax, pair.half_ay), min(pair.half_bx, pair.half_by));
    const auto swapped = b_has_reference<Real>(select(a_is_y, of_ay, of_ax), select(b_is_y, of_by, of_bx),
                                               nax * turned_x + nay * turned_y, size);

    // From here on in the frame of the box that has the reference.
    const F nx = select(swapped, nbx, nax), ny = select(swapped, nby, nay);
    const auto is_y = ny * ny > zero;
    const F half_x = select(swapped, pair.half_bx, pair.half_ax);
    const F half_y = select(swapped, pair.half_by, pair.half_ay);
    const F height = select(is_y, half_y, half_x), half = select(is_y, half_x, half_y);
    const F other_x = select(swapped, -bx, ax), other_y = select(swapped, -by, ay);
    const F centre_above = nx * other_x + ny * other_y, centre_along = nx * other_y - ny * other_x;

    // The other box's x axis along the normal and along the edge, and the side that faces the reference.
    const F turn = select(swapped, -sine, sine);
    const F above = cosine * nx + turn * ny, along = turn * nx - cosine * ny;
    const auto faces_x = abs(above) > abs(along);
    const F other_half_x = select(swapped, pair.half_ax, pair.half_bx);
    const F other_half_y = select(swapped, pair.half_ay, pair.half_by);
    const F facing_above = -select(faces_x, abs(above), abs(along));
    const F facing_along = select(faces_x, -sign(above) * along, sign(along) * above);
    const F depth = select(faces_x, other_half_x, other_half_y);
    const F width = select(faces_x, other_half_y, other_half_x);
    const F middle_above = centre_above + depth * facing_above - height;
    const F middle_along = centre_along + depth * facing_along;
    const F rise = width * facing_along, reach = width * facing_above;

    const FaceView<F> view{.from = -half,
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
    const Manifold<F> found = manifold_at_face<false, Real>(view, swapped);
    return with_normal_from(found, select(swapped, turned_x, nx), select(swapped, turned_y, ny));
}

}  // namespace
}  // namespace carom

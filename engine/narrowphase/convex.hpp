#pragma once

#include <limits>

#include "narrowphase/manifold.hpp"
#include "shapes/convex_shape.hpp"
#include "simd/scalar_lanes.hpp"

// Where two convex shapes touch: polygons of 1 to 8 vertices, grown by a radius. One text for numbers and for
// lanes: F is Real or a batch of it, a mask is bool or a batch of bools.
//
// The polygons decide the normal: that of the edge of either along which they are farthest apart, or least
// overlap. Where vertices are the nearest of both, the line between these has it instead. That edge, the
// reference, is the frame of what follows: `along` is measured along it, from the centre of its body,
// `above` along its normal, from the edge itself.

namespace carom {
namespace {

/// Share of the smaller inradius below which lengths of a manifold count as none: vertices so close to each
/// other have no direction, points so close are one point.
inline constexpr double kNoLength = 1e-4;

/// Vertices closer than so many round-offs of the distance of the centres have no direction either.
inline constexpr double kNoDirection = 256;

/// Share of the smaller inradius by which the face of b has to be farther from a than that of a from b to be
/// the reference of two faces that are parallel; so which of two stacked boxes has the reference does not
/// change with rounding.
inline constexpr double kBetterFace = 1e-3;
inline constexpr double kParallel = 0.9994;  // cosine of two degrees: faces within that are parallel

/// The incident edge (of the other shape, that faces the reference) as the reference edge sees it.
template <class F>
struct FaceView {
    F from, to;                    // m, along: ends of the reference edge
    F low_along, low_above;        // m, end of the incident edge that is lower along the reference
    F high_along, high_above;      // m, its other end
    F height;                      // m, of the reference edge over the centre of its body
    F centre_along, centre_above;  // m, of the other body, both from the centre of the reference's body
    F radius, other_radius;        // m, of the roundings
    F size;                        // m, the smaller inradius
};

/// A pair as its reference face sees it.
template <class F>
struct FacedPair {
    FaceView<F> view;
    F normal_x, normal_y;  // outward normal of the reference edge
    F side;                // 1: the reference is an edge of a; -1: of b
};

/// Points of a reference and an incident edge: the part of the incident edge that lies over the reference,
/// else the nearest points of both. Separations are not held against a margin.
/// @tparam kRounded  whether shapes may have a radius, and so be a disc
template <bool kRounded, class Real, class F>
[[gnu::always_inline]] inline Manifold<F> manifold_of(const FacedPair<F>& pair) {
    using simd::abs, simd::max, simd::min, simd::select, simd::sqrt;
    const F zero(Real(0)), one(Real(1)), half(Real(0.5));
    const FaceView<F>& view = pair.view;
    const auto b_has_reference = pair.side < zero;
    const F tolerance = F(static_cast<Real>(kNoLength)) * view.size;
    const F length = view.high_along - view.low_along, rise = view.high_above - view.low_above;

    const F from = max(view.low_along, view.from), to = min(view.high_along, view.to);
    const F slope = rise / select(length > tolerance, length, one);
    const F from_above = view.low_above + slope * (from - view.low_along);
    const F to_above = view.high_above + slope * (to - view.high_along);

    // The vertex of the incident edge that is nearest to the reference's line, and the reference's corner it
    // has passed, if it has. It and that corner are the nearest points if the corner lies beyond it too.
    const auto low_is_nearest = view.low_above <= view.high_above;
    const F vertex = select(low_is_nearest, view.low_along, view.high_along);
    const auto passes_end = vertex > view.to;
    const F corner = select(passes_end, view.to, view.from);
    auto passes_corner = passes_end | (vertex < view.from);
    if constexpr (kRounded) passes_corner = passes_corner | (view.to <= view.from);
    const F squared_length = length * length + rise * rise;
    const F from_low = (corner - view.low_along) * length - view.low_above * rise;
    const F within = select(low_is_nearest, from_low, squared_length - from_low);
    const auto is_corner = (passes_corner & (within <= -tolerance * (length + abs(rise)))) | (from > to);
    const F share = min(max(from_low / select(squared_length > zero, squared_length, one), zero), one);
    const F apart_along = view.low_along + share * length - corner;
    const F apart_above = view.low_above + share * rise;
    const F distance = sqrt(apart_along * apart_along + apart_above * apart_above);
    const F round_off = F(static_cast<Real>(kNoDirection) * std::numeric_limits<Real>::epsilon()) *
                        (abs(view.centre_along) + abs(view.centre_above));
    const auto has_direction = is_corner & (distance > max(tolerance, round_off));
    const F inverse = one / select(has_direction, distance, one);
    const F normal_along = select(has_direction, apart_along * inverse, zero);
    const F normal_above = select(has_direction, apart_above * inverse, one);

    // Both points from the reference edge: where they are and how far apart the polygons are there; ordered
    // along the tangent of the pair.
    F along1 = select(b_has_reference, to, from), along2 = select(b_has_reference, from, to);
    F above1 = select(b_has_reference, to_above, from_above);
    F above2 = select(b_has_reference, from_above, to_above);
    const auto is_single = is_corner | (to - from <= tolerance);
    const auto is_second = is_single & (above2 < above1);
    along1 = select(is_corner, corner + half * apart_along, select(is_second, along2, along1));
    above1 = select(is_corner, apart_above, select(is_second, above2, above1));
    along2 = select(is_single, along1, along2), above2 = select(is_single, above1, above2);
    const F separation1 = select(has_direction, distance, above1), separation2 = above2;
    F lowest = half * min(above1, above2), lowest_along = select(above1 <= above2, along1, along2);

    // Half way between the surfaces, from the centre of the reference's body.
    F height = view.height;
    if constexpr (kRounded) {
        const F shift = half * (view.radius - view.other_radius);
        along1 += shift * normal_along, along2 += shift * normal_along;
        lowest_along += shift * normal_along, height += shift * normal_above;
    }
    const F height1 = height + half * above1, height2 = height + half * above2;
    lowest += height;

    Manifold<F> found;
    const F nx = pair.side * normal_above, ny = pair.side * normal_along;
    const auto lever = [&](F above, F along) { return above * ny - along * nx; };
    const auto lever_t = [&](F above, F along) { return above * nx + along * ny; };
    const F lever1 = lever(height1, along1), lever2 = lever(height2, along2);
    const F both_t = lever_t(lowest, lowest_along);
    const F centre = lever(view.centre_above, view.centre_along);
    const F centre_t = lever_t(view.centre_above, view.centre_along);
    const F of_a = select(b_has_reference, centre, zero), of_b = centre - of_a;
    const F of_a_t = select(b_has_reference, centre_t, zero), of_b_t = centre_t - of_a_t;
    found.normal_x = pair.normal_x * nx - pair.normal_y * ny;
    found.normal_y = pair.normal_y * nx + pair.normal_x * ny;
    found.lever_a1 = lever1 - of_a, found.lever_a2 = lever2 - of_a;
    found.lever_b1 = lever1 - of_b, found.lever_b2 = lever2 - of_b;
    found.lever_a_t = both_t - of_a_t, found.lever_b_t = both_t - of_b_t;
    const F none(static_cast<Real>(kNoPoint));
    if constexpr (kRounded) {
        const F radii = view.radius + view.other_radius;
        found.separation1 = separation1 - radii;
        found.separation2 = select(is_single, none, separation2 - radii);
    } else {
        found.separation1 = separation1;
        found.separation2 = select(is_single, none, separation2);
    }
    return found;
}

/// Polygons, one a lane, in one frame; places beyond a polygon's vertices repeat the last.
template <class F>
struct Polygons {
    F x[kMostVertices], y[kMostVertices];
    F normal_x[kMostVertices], normal_y[kMostVertices];
    int count;  // of vertices of the largest
    int last;   // >= count - 1: place where every one has its last vertex
};

/// Turns and moves polygons.
template <class F>
[[gnu::always_inline]] inline void place(Polygons<F>& polygons, F cosine, F sine, F x, F y) {
    for (int i = 0; i <= polygons.last; ++i) {
        const F vx = polygons.x[i], vy = polygons.y[i];
        const F nx = polygons.normal_x[i], ny = polygons.normal_y[i];
        polygons.x[i] = x + (cosine * vx - sine * vy), polygons.y[i] = y + (sine * vx + cosine * vy);
        polygons.normal_x[i] = cosine * nx - sine * ny, polygons.normal_y[i] = sine * nx + cosine * ny;
    }
}

/// An edge of a polygon and how far from it another polygon is along its normal.
template <class F>
struct Face {
    F separation;
    F normal_x, normal_y;
    F from_x, from_y, to_x, to_y;
};

/// The edge of `of` from whose line `other` is farthest away, or which it overlaps least. Points have no
/// edge: their normal is zero and their separation -kNoPoint.
template <class Real, class F>
[[gnu::always_inline]] inline Face<F> farthest_face(const Polygons<F>& of, const Polygons<F>& other) {
    using simd::min, simd::select;
    Face<F> best{};
    for (int end = 0, from = of.last; end < of.count; from = end++) {
        const F nx = of.normal_x[from], ny = of.normal_y[from];
        F nearest = nx * other.x[0] + ny * other.y[0];
        for (int v = 1; v < other.count; ++v) nearest = min(nearest, nx * other.x[v] + ny * other.y[v]);
        const F separation = nearest - (nx * of.x[from] + ny * of.y[from]);
        const Face<F> face{separation, nx, ny, of.x[from], of.y[from], of.x[end], of.y[end]};
        if (end == 0) {
            best = face;
            continue;
        }
        const auto is_better = separation > best.separation;
        best.separation = select(is_better, face.separation, best.separation);
        best.normal_x = select(is_better, face.normal_x, best.normal_x);
        best.normal_y = select(is_better, face.normal_y, best.normal_y);
        best.from_x = select(is_better, face.from_x, best.from_x);
        best.from_y = select(is_better, face.from_y, best.from_y);
        best.to_x = select(is_better, face.to_x, best.to_x);
        best.to_y = select(is_better, face.to_y, best.to_y);
    }
    const F zero(Real(0));
    const auto is_point = best.normal_x * best.normal_x + best.normal_y * best.normal_y == zero;
    best.separation = select(is_point, F(static_cast<Real>(-kNoPoint)), best.separation);
    return best;
}

/// Whether b has the reference, of the faces that are farthest from the other shape.
/// @param cosine  between their normals
template <class Real, class F>
[[gnu::always_inline]] inline auto b_has_reference(F separation_of_a, F separation_of_b, F cosine, F size) {
    const F ahead = separation_of_b - separation_of_a;
    const auto is_better = ahead > F(static_cast<Real>(kBetterFace)) * size;
    return is_better | ((ahead > F(Real(0))) & (cosine > F(static_cast<Real>(-kParallel))));
}

/// Two convex shapes in the frame of a.
template <class F>
struct ConvexPair {
    Polygons<F> a, b;
    F b_x, b_y;  // m, the centre of b
    F radius_a, radius_b;
    F size;  // m, the smaller inradius
};

/// A pair as an edge of one of them sees it, in the frame of a.
/// @param face     of b where `swapped`, else of a
template <class Real, class F, class Mask>
[[gnu::always_inline]] inline void view_from(const Face<F>& face, Mask swapped, const ConvexPair<F>& pair,
                                             FacedPair<F>& found) {
    using simd::select;
    const F zero(Real(0)), one(Real(1));
    const F nx = face.normal_x, ny = face.normal_y;

    // The incident edge: its normal is most opposite to that of the reference.
    F most = one + one, low_x = zero, low_y = zero, high_x = zero, high_y = zero;
    const int count = pair.a.count > pair.b.count ? pair.a.count : pair.b.count;
    F high_before_x = select(swapped, pair.a.x[pair.a.last], pair.b.x[pair.b.last]);
    F high_before_y = select(swapped, pair.a.y[pair.a.last], pair.b.y[pair.b.last]);
    for (int end = 0, from = pair.a.last; end < count; from = end++) {
        const F edge_nx = select(swapped, pair.a.normal_x[from], pair.b.normal_x[from]);
        const F edge_ny = select(swapped, pair.a.normal_y[from], pair.b.normal_y[from]);
        const F end_x = select(swapped, pair.a.x[end], pair.b.x[end]);
        const F end_y = select(swapped, pair.a.y[end], pair.b.y[end]);
        const F facing = nx * edge_nx + ny * edge_ny;
        const auto is_better = facing < most;
        most = select(is_better, facing, most);
        high_x = select(is_better, high_before_x, high_x), high_y = select(is_better, high_before_y, high_y);
        low_x = select(is_better, end_x, low_x), low_y = select(is_better, end_y, low_y);
        high_before_x = end_x, high_before_y = end_y;
    }

    const F centre_x = select(swapped, pair.b_x, zero), centre_y = select(swapped, pair.b_y, zero);
    const F other_x = select(swapped, -pair.b_x, pair.b_x), other_y = select(swapped, -pair.b_y, pair.b_y);
    const auto along = [&](F x, F y) { return nx * y - ny * x; };
    const auto above = [&](F x, F y) { return nx * x + ny * y; };
    found.normal_x = nx, found.normal_y = ny, found.side = select(swapped, -one, one);
    found.view = {.from = along(face.from_x - centre_x, face.from_y - centre_y),
                  .to = along(face.to_x - centre_x, face.to_y - centre_y),
                  .low_along = along(low_x - centre_x, low_y - centre_y),
                  .low_above = above(low_x - face.from_x, low_y - face.from_y),
                  .high_along = along(high_x - centre_x, high_y - centre_y),
                  .high_above = above(high_x - face.from_x, high_y - face.from_y),
                  .height = above(face.from_x - centre_x, face.from_y - centre_y),
                  .centre_along = along(other_x, other_y),
                  .centre_above = above(other_x, other_y),
                  .radius = select(swapped, pair.radius_b, pair.radius_a),
                  .other_radius = select(swapped, pair.radius_a, pair.radius_b),
                  .size = pair.size};
}

/// A pair as one of two faces sees it, in the frame of a.
/// @param of_a, of_b  the face of each from which the other is farthest
template <class Real, class F>
[[gnu::always_inline]] inline void see_face(const ConvexPair<F>& pair, const Face<F>& of_a,
                                            const Face<F>& of_b, FacedPair<F>& found) {
    using simd::select;
    const F zero(Real(0)), one(Real(1));
    const F cosine = of_a.normal_x * of_b.normal_x + of_a.normal_y * of_b.normal_y;
    const auto swapped = b_has_reference<Real>(of_a.separation, of_b.separation, cosine, pair.size);
    Face<F> face;
    face.from_x = select(swapped, of_b.from_x, of_a.from_x);
    face.from_y = select(swapped, of_b.from_y, of_a.from_y);
    face.to_x = select(swapped, of_b.to_x, of_a.to_x), face.to_y = select(swapped, of_b.to_y, of_a.to_y);
    const F nx = select(swapped, of_b.normal_x, of_a.normal_x);
    const F ny = select(swapped, of_b.normal_y, of_a.normal_y);
    face.normal_x = select(nx * nx + ny * ny == zero, one, nx);  // two discs: any frame will do
    face.normal_y = ny;
    view_from<Real>(face, swapped, pair, found);
}

/// A pair as the face sees it from which one is farthest from the other, in the frame of a.
template <class Real, class F>
[[gnu::always_inline]] inline void find_face(const ConvexPair<F>& pair, FacedPair<F>& found) {
    const Face<F> of_a = farthest_face<Real>(pair.a, pair.b), of_b = farthest_face<Real>(pair.b, pair.a);
    see_face<Real>(pair, of_a, of_b, found);
}

}  // namespace
}  // namespace carom

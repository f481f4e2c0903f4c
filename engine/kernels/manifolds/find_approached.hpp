#pragma once

#include "kernels/manifolds/manifold_arguments.hpp"
#include "narrowphase/rectangle_gap.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// The rectangle around a body, turned as it is, its centre seen from a place at (x, y) from the body's.
template <class F, class Batch4>
[[gnu::always_inline]] inline Rectangle<F> turned_frame(F x, F y, F cos, F sin, const Batch4& frame) {
    return {x + (cos * frame[0] - sin * frame[1]),
            y + (sin * frame[0] + cos * frame[1]),
            cos,
            sin,
            frame[2],
            frame[3]};
}

/// Whether one of the axes of two rectangles parts them all through the step, whether either body keeps its
/// velocity along that axis, is stopped, or comes back with its restitution, as Gaps::can_close asks of a
/// manifold's normal.
/// @param motion_a, motion_b  FindApproached::motion
/// @param least  m, gaps up to here do not part
template <class F, class Batch4>
[[gnu::always_inline]] inline auto stay_parted(const Rectangle<F>& a, const Rectangle<F>& b,
                                               const Batch4& motion_a, const Batch4& motion_b, F least) {
    using simd::abs, simd::max, simd::select;
    const F zero(0), x = b.x - a.x, y = b.y - a.y, e = max(motion_a[3], motion_b[3]),
                     turns = motion_a[2] + motion_b[2] + least;
    const F c = abs(a.cos * b.cos + a.sin * b.sin), s = abs(a.cos * b.sin - a.sin * b.cos);
    const auto parts = [&](F cos, F sin, F extents) {
        const F across = cos * x + sin * y, side = select(across < zero, F(-1), F(1));
        const F of_a = side * (cos * motion_a[0] + sin * motion_a[1]),
                of_b = side * (cos * motion_b[0] + sin * motion_b[1]);
        return abs(across) - extents > max(of_a, -e * of_a) + max(-of_b, e * of_b) + turns;
    };
    return parts(a.cos, a.sin, a.half_x + (b.half_x * c + b.half_y * s)) |
           parts(-a.sin, a.cos, a.half_y + (b.half_x * s + b.half_y * c)) |
           parts(b.cos, b.sin, b.half_x + (a.half_x * c + a.half_y * s)) |
           parts(-b.sin, b.cos, b.half_y + (a.half_x * s + a.half_y * c));
}

/// Looks at those of the pairs first ... last whose bodies have come farther than they may before that, and
/// says until when they may wait. Lists those that may touch in this step.
/// @param first  a multiple of kRowPadding
/// @return how many it has listed
template <class Real, class Isa>
std::size_t find_approached(const FindApproached<Real>& k, std::size_t first, std::size_t last) {
    using L = simd::Lanes<Real, Isa>;
    using F = typename L::Batch;
    const F zero(0), rounding(k.rounding);
    std::size_t count = 0;
    for (std::size_t i = first; i < last; i += L::size) {
        const std::int32_t *a = k.a + i, *b = k.b + i;
        const F come = L::gather_at(k.come, a) + L::gather_at(k.come, b), until = L::load(k.until + i);
        const auto is_due = come > until;
        if (!simd::any(is_due)) continue;
        const auto pose_a = L::load_rows4(k.pose, a), pose_b = L::load_rows4(k.pose, b),
                   frame_a = L::load_rows4(k.frame, a), frame_b = L::load_rows4(k.frame, b);
        // Seen from the body a: far from the origin centres would be rounded.
        const Rectangle<F> of_a = turned_frame(zero, zero, pose_a[2], pose_a[3], frame_a),
                           of_b = turned_frame(pose_b[0] - pose_a[0], pose_b[1] - pose_a[1], pose_b[2],
                                               pose_b[3], frame_b);
        const F gap = rectangle_gap(of_a, of_b);
        const F sides = frame_a[2] + frame_a[3] + frame_b[2] + frame_b[3];
        const F reach = F(k.share) * L::load(k.thickness + i) + F(k.fall),
                way = L::gather_at(k.way, a) + L::gather_at(k.way, b);
        const F off = rounding * (come + reach + sides);  // what is rounded
        const F now_until = come + (gap - way - reach) - off;
        L::store(k.until + i, simd::select(is_due, now_until, until));
        auto is_near = is_due & !(come <= now_until);
        // What is slow is in contact soon, and contacts that come late are the last in order.
        const auto is_swift = is_near & (way > reach);
        if (k.motion && simd::any(is_swift)) {
            const auto motion_a = L::load_rows4(k.motion, a), motion_b = L::load_rows4(k.motion, b);
            is_near = is_near & !(is_swift & stay_parted(of_a, of_b, motion_a, motion_b, reach + off));
        }
        auto bits = static_cast<unsigned>(simd::bitmask(is_near));
        if (last - i < L::size) bits &= (1u << (last - i)) - 1;
        for (; bits != 0; bits &= bits - 1)
            k.out[count++] = static_cast<std::int32_t>(i) + __builtin_ctz(bits);
    }
    return count;
}

}  // namespace
}  // namespace carom

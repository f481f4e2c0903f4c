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
        const F gap = rectangle_gap(
            turned_frame(zero, zero, pose_a[2], pose_a[3], frame_a),
            turned_frame(pose_b[0] - pose_a[0], pose_b[1] - pose_a[1], pose_b[2], pose_b[3], frame_b));
        const F sides = frame_a[2] + frame_a[3] + frame_b[2] + frame_b[3];
        const F reach = F(k.share) * L::load(k.thickness + i) + F(k.fall),
                way = L::gather_at(k.way, a) + L::gather_at(k.way, b);
        const F now_until = come + (gap - way - reach) - rounding * (come + reach + sides);
        L::store(k.until + i, simd::select(is_due, now_until, until));
        const auto is_near = is_due & !(come <= now_until);
        auto bits = static_cast<unsigned>(simd::bitmask(is_near));
        if (last - i < L::size) bits &= (1u << (last - i)) - 1;
        for (; bits != 0; bits &= bits - 1)
            k.out[count++] = static_cast<std::int32_t>(i) + __builtin_ctz(bits);
    }
    return count;
}

}  // namespace
}  // namespace carom

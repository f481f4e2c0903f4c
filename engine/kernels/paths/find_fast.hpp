#pragma once

#include <algorithm>
#include <limits>

#include "kernels/paths/path_lanes.hpp"

namespace carom {
namespace {

/// Tells which contacts have a point that comes faster than SolvePaths::fast, by the velocities given, and
/// are not pressed by more than SolvePaths::light_press. What rounding leaves open is told, too, and what
/// would be if joints that hold one of the bodies had it half a kick of gravity faster.
template <class Real, class Isa>
PathCounts find_fast(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    using simd::abs, simd::max, simd::min;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    // Six sums and products lead to a velocity, each off by half of this at most.
    constexpr Real kRounding = 8 * std::numeric_limits<Real>::epsilon();
    const F rounding(kRounding), less(1 - kRounding), more(1 + kRounding);
    const F fast(k.fast), light(k.light_press), half_kick(k.fall / 2);
    std::fill(k.is_fast + k.first_link[first], k.is_fast + k.first_link[last], 0U);
    for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
        auto near = Lanes::load_rows4(k.velocity, p.near_rows(0));
        for (std::size_t i = 0; i < p.length; ++i) {
            const PathLink<Real>& link = p.link[i];
            const LinkLanes<Lanes, Real> l(link, p.lane);
            const auto far = Lanes::load_rows4(k.velocity, p.far_rows(i));
            const F dx = far[0] - near[0], dy = far[1] - near[1];
            F v1, v2, vt;
            l.relative(dx, dy, near[2], far[2], v1, v2, vt);
            const F parts = abs(dx) + abs(dy) + abs(near[2]) * max(abs(l.near1), abs(l.near2)) +
                            abs(far[2]) * max(abs(l.far1), abs(l.far2));
            const F off = rounding * parts, v = min(v1, v2);
            const F pressing = Lanes::load(link.normal1 + p.lane) + Lanes::load(link.normal2 + p.lane),
                    inverse_mass = abs(near[3]) + abs(far[3]);
            const auto is_pressed = pressing * inverse_mass * less > light * ((half_kick - v) + off) * more;
            const auto bits = static_cast<unsigned>(simd::bitmask((v + fast < off) & !is_pressed));
            k.is_fast[&link - k.links] |= bits << p.lane;
            near = far;
        }
    });
    return {};
}

}  // namespace
}  // namespace carom

#pragma once

#include <algorithm>
#include <limits>

#include "kernels/paths/part_paths.hpp"
#include "kernels/paths/path_lanes.hpp"
#include "narrowphase/manifold.hpp"

namespace carom {
namespace {

/// How large the parts of a relative velocity are, or of a way, that rounding goes by.
template <class Lanes, class Real, class F>
[[gnu::always_inline]] inline F sum_of_parts(const LinkLanes<Lanes, Real>& l, F dx, F dy, F of_near,
                                             F of_far) {
    using simd::abs, simd::max;
    return abs(dx) + abs(dy) + abs(of_near) * max(abs(l.near1), abs(l.near2)) +
           abs(of_far) * max(abs(l.far1), abs(l.far2));
}

/// Whether no point of a contact is met before the end of the substep, whatever rounding leaves open.
template <class Lanes, class Real>
[[gnu::always_inline]] inline auto stay_apart(const PathBatch<Real>& p, const LinkLanes<Lanes, Real>& l,
                                              std::size_t i, typename Lanes::Batch rounding) {
    using F = typename Lanes::Batch;
    using simd::abs;
    const SolvePaths<Real>& k = p.k;
    const PathLink<Real>& link = p.link[i];
    const PathPlace<Lanes> near(k.displacement, k.turn, p.near_rows(i)),
        far(k.displacement, k.turn, p.far_rows(i));
    const auto soon_near = Lanes::load_rows4(k.foreseen, p.near_rows(i)),
               soon_far = Lanes::load_rows4(k.foreseen, p.far_rows(i));
    const F h(k.h), come_x = far.at[0] - near.at[0], come_y = far.at[1] - near.at[1],
                    dx = soon_far[0] - soon_near[0], dy = soon_far[1] - soon_near[1];
    F way1, way2, v1, v2, along;
    l.relative(come_x, come_y, near.turn, far.turn, way1, way2, along);
    l.relative(dx, dy, soon_near[2], soon_far[2], v1, v2, along);
    const F separation1 = Lanes::load(link.separation1 + p.lane),
            separation2 = Lanes::load(link.separation2 + p.lane);
    const F parts = sum_of_parts(l, come_x, come_y, near.turn, far.turn) +
                    h * sum_of_parts(l, dx, dy, soon_near[2], soon_far[2]);
    const auto stays = [&](F separation, F way, F v) {
        return separation + way + h * v > rounding * (abs(separation) + parts);
    };
    return stays(separation1, way1, v1) & stays(separation2, way2, v2);
}

/// Tells which contacts have a point that comes faster than SolvePaths::fast, by the velocities given, and
/// are not pressed by more than SolvePaths::light_press. What rounding leaves open is told, too, and what
/// would be if joints that hold one of the bodies had it half a kick of gravity faster. Those that come
/// faster than SolvePaths::surely_fast and surely do not meet in the substep are told by themselves.
template <class Real, class Isa>
PathCounts find_fast(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    using simd::abs, simd::min;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    // Six sums and products lead to a velocity, each off by half of this at most.
    constexpr Real kRounding = 8 * std::numeric_limits<Real>::epsilon();
    const F rounding(kRounding), less(1 - kRounding), more(1 + kRounding);
    const F fast(k.fast), surely_fast(k.surely_fast), light(k.light_press), half_kick(k.fall / 2),
        none(static_cast<Real>(kNoPoint));
    for (std::uint32_t* const bits : {k.is_fast, k.comes})
        std::fill(bits + k.first_link[first], bits + k.first_link[last], 0U);
    for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
        auto near = Lanes::load_rows4(k.velocity, p.near_rows(0));
        for (std::size_t i = 0; i < p.length; ++i) {
            const PathLink<Real>& link = p.link[i];
            const LinkLanes<Lanes, Real> l(link, p.lane);
            const auto far = Lanes::load_rows4(k.velocity, p.far_rows(i));
            const F dx = far[0] - near[0], dy = far[1] - near[1];
            F v1, v2, vt;
            l.relative(dx, dy, near[2], far[2], v1, v2, vt);
            const F off = rounding * sum_of_parts(l, dx, dy, near[2], far[2]), v = min(v1, v2);
            const F pressing = Lanes::load(link.normal1 + p.lane) + Lanes::load(link.normal2 + p.lane),
                    inverse_mass = abs(near[3]) + abs(far[3]);
            const auto is_pressed = pressing * inverse_mass * less > light * ((half_kick - v) + off) * more;
            const auto number = &link - k.links;
            const auto may = (v + fast < off) & !is_pressed;
            near = far;
            const auto fast_bits = static_cast<unsigned>(simd::bitmask(may));
            if (fast_bits == 0) continue;
            const auto is_light = pressing * inverse_mass * more < light * ((-half_kick - v) - off) * less;
            const auto is_fast =
                (v1 + surely_fast < -off) |
                ((v2 + surely_fast < -off) & (Lanes::load(link.separation2 + p.lane) < none));
            const auto comes = is_light & is_fast & stay_apart<Lanes>(p, l, i, rounding);
            const unsigned bits = fast_bits & static_cast<unsigned>(simd::bitmask(comes));
            k.is_fast[number] |= (fast_bits & ~bits) << p.lane;
            k.comes[number] |= bits << p.lane;
        }
    });
    return {};
}

}  // namespace
}  // namespace carom

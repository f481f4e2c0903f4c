#pragma once

#include "kernels/paths/part_paths.hpp"
#include "kernels/paths/path_lanes.hpp"
#include "kernels/paths/sweep_paths.hpp"

// Contacts beside the paths: kPathLanes of them are a link and a bundle, whatever bodies they share. A
// substep asks of all whether they close; those that do are solved one after the other, so that the bits do
// not depend on the width of a batch. docs/decisions/0043-contacts-beside-paths.md.

namespace carom {
namespace {

/// Which contacts come in faster than their floors or carry an impulse: SolvePaths::closing.
/// @tparam kFindsFloors  whether to find the floors of the substep first; they change with displacements
/// alone
template <class Real, class Isa, bool kFindsFloors>
PathCounts watch_paths(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    const F zero(0), tolerance(k.velocity_tolerance);
    std::fill(k.closing + first, k.closing + last, 0U);
    for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
        PathLink<Real>& link = *p.link;
        const std::int32_t *near_rows = p.near_rows(0), *far_rows = p.far_rows(0);
        const LinkLanes<Lanes, Real> l(link, p.lane);
        if constexpr (kFindsFloors) {
            const PathPlace<Lanes> near(k.displacement, k.turn, near_rows),
                far(k.displacement, k.turn, far_rows);
            F s1, s2, along;
            l.relative(far.at[0] - near.at[0], far.at[1] - near.at[1], near.turn, far.turn, s1, s2, along);
            s1 += Lanes::load(link.separation1 + p.lane), s2 += Lanes::load(link.separation2 + p.lane);
            Lanes::store(link.floor1 + p.lane, simd::min(-s1 * F(k.inverse_h), zero));
            Lanes::store(link.floor2 + p.lane, simd::min(-s2 * F(k.inverse_h), zero));
        }
        const PathBody<Lanes> a{Lanes::load_rows4(k.velocity, near_rows)},
            b{Lanes::load_rows4(k.velocity, far_rows)};
        F v1, v2, vt;
        l.relative(b.record[0] - a.record[0], b.record[1] - a.record[1], a.record[2], b.record[2], v1, v2,
                   vt);
        const F floor1 = Lanes::load(link.floor1 + p.lane), floor2 = Lanes::load(link.floor2 + p.lane),
                pressed = Lanes::load(link.normal1 + p.lane) + Lanes::load(link.normal2 + p.lane);
        const auto closes = (v1 < floor1 - tolerance) | (v2 < floor2 - tolerance) | (pressed > zero);
        const auto bundle = static_cast<std::size_t>(p.head - k.heads) / kPathLanes;
        k.closing[bundle] |= static_cast<std::uint32_t>(simd::bitmask(closes)) << p.lane;
    });
    return {};
}

/// One Gauss-Seidel sweep over the contacts that close, in their order.
template <class Real>
PathCounts settle_watched(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    PathCounts counts;
    for (std::size_t bundle = first; bundle < last; ++bundle) {
        counts.closing += static_cast<std::size_t>(__builtin_popcount(k.closing[bundle]));
        for (std::uint32_t left = k.closing[bundle]; left != 0; left &= left - 1) {
            const auto lane = static_cast<std::size_t>(__builtin_ctz(left));
            const PathBatch<Real> one{k, k.links + k.first_link[bundle], 1, lane,
                                      k.heads + bundle * kPathLanes + lane};
            sweep_paths<simd::Lanes<Real, simd::Scalar>>(one, true, true);
        }
    }
    return counts;
}

}  // namespace
}  // namespace carom

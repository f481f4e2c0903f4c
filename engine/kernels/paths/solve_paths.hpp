#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>

#include "kernels/paths/part_paths.hpp"
#include "kernels/paths/path_system.hpp"
#include "kernels/paths/unsettled_paths.hpp"

// The kernels of a substep over paths of contacts: kernels/paths/path_system.hpp says how a path is solved.

namespace carom {
namespace {

/// Separations of contacts that are carried on from the step before, moved by what the bodies have come in
/// it.
template <class Real, class Isa>
PathCounts carry_paths(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    for_each_path_batch<Lanes>(k, first, last, [](const PathBatch<Real>& p) { carry_batch<Lanes>(p); });
    return {};
}

/// The first pass of a substep over bundles: floors, displacements, and the exact solve of each path.
template <class Real, class Isa>
PathCounts solve_paths(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    static_assert(sizeof(LinkScratch<Lanes>) <= kPathScratchBytes);
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    auto* scratch = static_cast<LinkScratch<Lanes>*>(k.scratch);
    std::size_t longest = 0;
    for (std::size_t bundle = first; bundle < last; ++bundle)
        longest = std::max(longest, k.first_link[bundle + 1] - k.first_link[bundle]);
    UnsettledPaths<Lanes, Real> unsettled(
        k, scratch,
        reinterpret_cast<PathLink<Real>*>(static_cast<std::byte*>(k.scratch) +
                                          (longest + 1) * kPathScratchBytes));
    PathCounts counts;
    bool is_left_out = false;  // the bundle, by what its lanes did before any of them is solved
    for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
        const auto first_lane = static_cast<std::size_t>(p.head - k.heads);
        if (p.lane == 0) is_left_out = rests(k, first_lane / kPathLanes);
        if (is_left_out) return;
        part_paths<Lanes>(p);
        F restless;
        const bool is_slender = k.is_slender[first_lane / kPathLanes] != 0;
        const auto bad = solve_exactly<Lanes>(p, scratch, is_slender ? k.most_of_slender : k.most_iterations,
                                              F(0) <= F(0), restless);
        Lanes::store(k.restless + first_lane, simd::select(bad, F(static_cast<Real>(kUnsettled)), restless));
        const unsigned is_bad = simd::bitmask(bad);
        if (is_bad == 0) return;
        counts.unsettled += static_cast<std::size_t>(std::popcount(is_bad));
        if (last - first > 1)
            unsettled.add(p, is_bad);
        else
            solve_unsettled<Lanes>(p, scratch, bad);  // no other has any
    });
    unsettled.finish();
    return counts;
}

}  // namespace
}  // namespace carom

#pragma once

#include "kernels/paths/path_lanes.hpp"

// What a step begins with along paths of contacts.

namespace carom {
namespace {

/// Gives the bodies the impulses that their contacts had at the end of the step before.
template <class Real, class Isa>
PathCounts warm_start_paths(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
        for (std::size_t i = 0; i < p.length; ++i) {
            const PathLink<Real>& link = p.link[i];
            const LinkLanes<Lanes, Real> l(link, p.lane);
            PathBody<Lanes> a{Lanes::load_rows4(k.velocity, p.near_rows(i))},
                b{Lanes::load_rows4(k.velocity, p.far_rows(i))};
            const F n1 = Lanes::load(link.normal1 + p.lane), n2 = Lanes::load(link.normal2 + p.lane),
                    t = Lanes::load(link.tangent + p.lane);
            F jx, jy;
            l.impulse(n1 + n2, t, jx, jy);
            a.apply(F(-1), jx, jy, l.near1 * n1 + l.near2 * n2 + l.near_t * t);
            b.apply(F(1), jx, jy, l.far1 * n1 + l.far2 * n2 + l.far_t * t);
            Lanes::store_rows4(k.velocity, p.near_rows(i), a.record);
            Lanes::store_rows4(k.velocity, p.far_rows(i), b.record);
        }
    });
    return {};
}

}  // namespace
}  // namespace carom

#pragma once

#include <algorithm>

#include "kernels/paths/path_lanes.hpp"

// Gauss-Seidel sweeps along paths of contacts.

namespace carom {
namespace {

/// Solves a link alone: its impulses, and what they do to its bodies.
/// @param where  lanes that are solved
template <class Lanes, class Real>
[[gnu::always_inline]] inline void sweep_link(PathLink<Real>& link, std::size_t lane,
                                              typename Lanes::Mask where, PathBody<Lanes>& a,
                                              PathBody<Lanes>& b) {
    using F = typename Lanes::Batch;
    const F zero(0);
    const LinkLanes<Lanes, Real> l(link, lane);
    const LinkMass<F> mass(l, a.inverse_mass(), a.inverse_rim_mass(), b.inverse_mass(), b.inverse_rim_mass());
    F v1, v2, vt;
    l.relative(b.record[0] - a.record[0], b.record[1] - a.record[1], a.record[2], b.record[2], v1, v2, vt);
    const F old1 = Lanes::load(link.normal1 + lane), old2 = Lanes::load(link.normal2 + lane),
            old_t = Lanes::load(link.tangent + lane);
    F new1, new2;
    solve_two_normals(mass.k11, mass.k12, mass.k22,
                      v1 - Lanes::load(link.floor1 + lane) - mass.k11 * old1 - mass.k12 * old2,
                      v2 - Lanes::load(link.floor2 + lane) - mass.k12 * old1 - mass.k22 * old2, new1, new2);
    // Lanes of shorter paths have no mass: what is no number there must not be kept.
    const auto moves = where & (mass.k11 > zero);
    new1 = simd::select(moves, new1, old1), new2 = simd::select(moves, new2, old2);
    const F add1 = new1 - old1, add2 = new2 - old2;
    const F vt_now = vt + mass.k1t * add1 + mass.k2t * add2;
    const F limit = Lanes::load(link.friction + lane) * (new1 + new2);
    const F new_t =
        simd::select(moves, simd::min(simd::max(old_t - vt_now / mass.ktt, -limit), limit), old_t);
    const F add_t = new_t - old_t;
    F jx, jy;
    l.impulse(add1 + add2, add_t, jx, jy);
    a.apply(F(-1), jx, jy, l.near1 * add1 + l.near2 * add2 + l.near_t * add_t);
    b.apply(F(1), jx, jy, l.far1 * add1 + l.far2 * add2 + l.far_t * add_t);
    Lanes::store(link.normal1 + lane, new1), Lanes::store(link.normal2 + lane, new2);
    Lanes::store(link.tangent + lane, new_t);
}

/// One Gauss-Seidel sweep along the paths, of the lanes in `where` alone. The body between two links is not
/// stored and loaded again.
template <class Lanes, class Real>
void sweep_paths(const PathBatch<Real>& p, bool is_forward, typename Lanes::Mask where) {
    Real* const velocity = p.k.velocity;
    if (is_forward) {
        PathBody<Lanes> a{Lanes::load_rows4(velocity, p.head)};
        for (std::size_t i = 0; i < p.length; ++i) {
            PathBody<Lanes> b{Lanes::load_rows4(velocity, p.far_rows(i))};
            sweep_link(p.link[i], p.lane, where, a, b);
            Lanes::store_rows4(velocity, p.near_rows(i), a.record);
            a = b;
        }
        Lanes::store_rows4(velocity, p.far_rows(p.length - 1), a.record);
    } else {
        PathBody<Lanes> b{Lanes::load_rows4(velocity, p.far_rows(p.length - 1))};
        for (std::size_t i = p.length; i-- > 0;) {
            PathBody<Lanes> a{Lanes::load_rows4(velocity, p.near_rows(i))};
            sweep_link(p.link[i], p.lane, where, a, b);
            Lanes::store_rows4(velocity, p.far_rows(i), b.record);
            b = a;
        }
        Lanes::store_rows4(velocity, p.head, b.record);
    }
}

/// Whether a bundle is left out: all of its paths were slow when they were solved last.
template <class Real>
bool rests(const SolvePaths<Real>& k, std::size_t bundle) {
    if (!(k.resting_speed > 0) || k.is_slender[bundle] != 0) return false;
    const Real* const speeds = k.restless + kPathLanes * bundle;
    return *std::max_element(speeds, speeds + kPathLanes) < k.resting_speed;
}

/// The last pass of a substep: a sweep over all links, of bundles that do not rest.
template <class Real, class Isa>
PathCounts sweep_all_paths(const SolvePaths<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t bundle = first; bundle < last; ++bundle)
        if (!rests(k, bundle))
            for_each_path_batch<Lanes>(k, bundle, bundle + 1, [&](const PathBatch<Real>& p) {
                sweep_paths<Lanes>(p, true, F(0) <= F(0));
            });
    return {};
}

}  // namespace
}  // namespace carom

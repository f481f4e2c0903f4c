#pragma once

#include <algorithm>

#include "kernels/paths/path_lanes.hpp"

// What engine/solvers/contact_sets/coarse_correction.hpp does to the contacts of paths: the same as
// kernels/contacts/coarse_correction.hpp, where load and stress are explained, does to those of discs.

namespace carom {
namespace {

/// The numbers of a link that coarse correction asks for, a lane a path.
template <class Lanes, class Real>
struct LoadedLink {
    using F = typename Lanes::Batch;
    const std::int32_t *near, *far;  // rows
    PathBody<Lanes> a, b;
    F normal1, normal2, tangent;
    F share;  // that either body has of the contact: a half, all where nothing moves the other one

    LoadedLink(const PathBatch<Real>& p, std::size_t i)
        : near(p.near_rows(i)),
          far(p.far_rows(i)),
          a{Lanes::load_rows4(p.k.velocity, near)},
          b{Lanes::load_rows4(p.k.velocity, far)},
          normal1(Lanes::load(p.link[i].normal1 + p.lane)),
          normal2(Lanes::load(p.link[i].normal2 + p.lane)),
          tangent(Lanes::load(p.link[i].tangent + p.lane)),
          share(simd::select((a.inverse_mass() > F(0)) & (b.inverse_mass() > F(0)), F(Real(0.5)), F(1))) {}

    /// s of the contact. That of what nothing moves is zero.
    F scale(const SolvePaths<Real>& k) const {
        return share * (Lanes::gather_at(k.coarse.scale, near) + Lanes::gather_at(k.coarse.scale, far));
    }
};

/// Places of bodies. What is no body has that of the last one, and no stress to use it for.
template <class Lanes, class Real>
typename Lanes::Batch4 places_of(const SolvePaths<Real>& k, const std::int32_t* rows) {
    alignas(64) std::int32_t within[Lanes::size];
    for (std::size_t i = 0; i < Lanes::size; ++i) within[i] = std::min(rows[i], k.coarse.last_row);
    return Lanes::load_rows4(k.coarse.motion, within);
}

template <class Lanes, class Real>
void sum_link(const PathBatch<Real>& p, std::size_t i) {
    using F = typename Lanes::Batch;
    const SolvePaths<Real>& k = p.k;
    const PathLink<Real>& link = p.link[i];
    const LinkLanes<Lanes, Real> l(link, p.lane);
    const LoadedLink<Lanes, Real> c(p, i);
    F x, y, v1, v2, vt;
    l.impulse(c.normal1 + c.normal2, c.tangent, x, y);
    l.relative(c.b.record[0] - c.a.record[0], c.b.record[1] - c.a.record[1], c.a.record[2], c.b.record[2], v1,
               v2, vt);
    const F rate = c.share * (c.normal1 * (v1 - Lanes::load(link.floor1 + p.lane)) +
                              c.normal2 * (v2 - Lanes::load(link.floor2 + p.lane)) + c.tangent * vt);
    auto load_a = Lanes::load_rows4(k.coarse.load, c.near), load_b = Lanes::load_rows4(k.coarse.load, c.far);
    load_a[0] -= x, load_a[1] -= y, load_a[2] += rate;
    load_b[0] += x, load_b[1] += y, load_b[2] += rate;
    Lanes::store_rows4(k.coarse.load, c.near, load_a), Lanes::store_rows4(k.coarse.load, c.far, load_b);

    // Seen from either body the other one is half of s' (b - a) away, with the impulse turned round.
    const auto at_a = places_of<Lanes>(k, c.near), at_b = places_of<Lanes>(k, c.far);
    const F half(Real(0.5)), arm_x = half * (at_b[0] - at_a[0]), arm_y = half * (at_b[1] - at_a[1]);
    const auto both = c.share < F(1);
    const F xx = simd::select(both, x * arm_x, F(0)), xy = simd::select(both, x * arm_y, F(0)),
            yx = simd::select(both, y * arm_x, F(0)), yy = simd::select(both, y * arm_y, F(0));
    for (const std::int32_t* rows : {c.near, c.far}) {
        auto stress = Lanes::load_rows4(k.coarse.stress, rows);
        stress[0] -= xx, stress[1] -= xy, stress[2] -= yx, stress[3] -= yy;
        Lanes::store_rows4(k.coarse.stress, rows, stress);
    }
}

/// Multiplies the impulses of a link.
template <class Lanes, class Real>
void multiply_link(const PathBatch<Real>& p, std::size_t i, const LoadedLink<Lanes, Real>& c,
                   typename Lanes::Batch factor) {
    PathLink<Real>& link = p.link[i];
    Lanes::store(link.normal1 + p.lane, c.normal1 * factor);
    Lanes::store(link.normal2 + p.lane, c.normal2 * factor);
    Lanes::store(link.tangent + p.lane, c.tangent * factor);
}

template <class Lanes, class Real>
void scale_link(const PathBatch<Real>& p, std::size_t i) {
    using F = typename Lanes::Batch;
    const LinkLanes<Lanes, Real> l(p.link[i], p.lane);
    LoadedLink<Lanes, Real> c(p, i);
    const F s = c.scale(p.k), n1 = s * c.normal1, n2 = s * c.normal2, t = s * c.tangent;
    F jx, jy;
    l.impulse(n1 + n2, t, jx, jy);
    c.a.apply(F(-1), jx, jy, l.near1 * n1 + l.near2 * n2 + l.near_t * t);
    c.b.apply(F(1), jx, jy, l.far1 * n1 + l.far2 * n2 + l.far_t * t);
    Lanes::store_rows4(p.k.velocity, c.near, c.a.record), Lanes::store_rows4(p.k.velocity, c.far, c.b.record);
    multiply_link<Lanes>(p, i, c, F(1) + s);
}

template <class Lanes, class Real>
void retain_link(const PathBatch<Real>& p, std::size_t i) {
    using F = typename Lanes::Batch;
    const LoadedLink<Lanes, Real> c(p, i);
    const F s = c.scale(p.k);
    multiply_link<Lanes>(p, i, c, (F(1) + F(p.k.coarse.kept) * s) / (F(1) + s));
}

/// Calls fn(batch, link) for each link of each batch; one lane after the other where contacts may share
/// bodies.
template <class Real, class Isa, class Fn>
[[gnu::always_inline]] inline PathCounts for_each_loaded_link(const SolvePaths<Real>& arguments,
                                                              std::size_t first, std::size_t last,
                                                              const Fn& fn) {
    const SolvePaths<Real> k = arguments;  // a copy: no store can change it
    const auto all = [&]<class Lanes>(Lanes) {
        for_each_path_batch<Lanes>(k, first, last, [&](const PathBatch<Real>& p) {
            for (std::size_t i = 0; i < p.length; ++i) fn(Lanes{}, p, i);
        });
    };
    if (k.coarse.is_beside)
        all(simd::Lanes<Real, simd::Scalar>{});
    else
        all(simd::Lanes<Real, Isa>{});
    return {};
}

/// Adds the loads of contacts to those of their bodies.
template <class Real, class Isa>
PathCounts sum_path_loads(const SolvePaths<Real>& k, std::size_t first, std::size_t last) {
    return for_each_loaded_link<Real, Isa>(
        k, first, last,
        []<class Lanes>(Lanes, const PathBatch<Real>& p, std::size_t i) { sum_link<Lanes>(p, i); });
}

/// Gives the bodies the share s of their contacts' impulses once more, which become 1 + s times what they
/// were.
template <class Real, class Isa>
PathCounts scale_path_loads(const SolvePaths<Real>& k, std::size_t first, std::size_t last) {
    return for_each_loaded_link<Real, Isa>(
        k, first, last,
        []<class Lanes>(Lanes, const PathBatch<Real>& p, std::size_t i) { scale_link<Lanes>(p, i); });
}

/// Leaves the contacts `kept` of what scaling added.
template <class Real, class Isa>
PathCounts retain_path_loads(const SolvePaths<Real>& k, std::size_t first, std::size_t last) {
    return for_each_loaded_link<Real, Isa>(
        k, first, last,
        []<class Lanes>(Lanes, const PathBatch<Real>& p, std::size_t i) { retain_link<Lanes>(p, i); });
}

}  // namespace
}  // namespace carom

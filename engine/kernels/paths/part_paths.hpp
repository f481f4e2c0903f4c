#pragma once

#include "kernels/paths/path_lanes.hpp"

// What a substep begins with along paths of contacts: how fast points may approach, and a share of the
// overlaps taken away by displacements, which give no body a velocity.

namespace carom {
namespace {

/// Displacement and rim displacement of a body since the start of the step.
template <class Lanes>
struct PathPlace {
    typename Lanes::Batch2 at;
    typename Lanes::Batch turn;

    template <class Real>
    PathPlace(const Real* displacement, const Real* turns, const std::int32_t* rows)
        : at(Lanes::load_rows2(displacement, rows)), turn(Lanes::gather_at(turns, rows)) {}
    template <class Real>
    void store(const SolvePaths<Real>& k, const std::int32_t* rows) const {
        Lanes::store_rows2(k.displacement, rows, at), Lanes::scatter_at(k.turn, rows, turn);
    }
};

/// The separations at the start of the step, of those at the start of the one before.
template <class Lanes, class Real>
void carry_batch(const PathBatch<Real>& p) {
    using F = typename Lanes::Batch;
    const SolvePaths<Real>& k = p.k;
    PathPlace<Lanes> near(k.come, k.turned, p.head);
    for (std::size_t i = 0; i < p.length; ++i) {
        PathLink<Real>& link = p.link[i];
        const LinkLanes<Lanes, Real> l(link, p.lane);
        const PathPlace<Lanes> far(k.come, k.turned, p.far_rows(i));
        F s1, s2, along;
        l.relative(far.at[0] - near.at[0], far.at[1] - near.at[1], near.turn, far.turn, s1, s2, along);
        Lanes::store(link.separation1 + p.lane, Lanes::load(link.separation1 + p.lane) + s1);
        Lanes::store(link.separation2 + p.lane, Lanes::load(link.separation2 + p.lane) + s2);
        near = far;
    }
}

/// Takes away a share of how deep a contact overlaps beyond its slop, by displacing and turning both bodies.
/// What is slow has a slop: docs/decisions/0037-heaps-that-lie-still.md.
/// @param s1, s2  m, separations of the points
/// @return whether a lane has moved
template <class Lanes, class Real>
bool part_bodies(const SolvePaths<Real>& k, const PathLink<Real>& link, std::size_t lane,
                 const LinkLanes<Lanes, Real>& l, const PathBody<Lanes>& a, const PathBody<Lanes>& b,
                 typename Lanes::Batch s1, typename Lanes::Batch s2, PathPlace<Lanes>& near,
                 PathPlace<Lanes>& far) {
    using F = typename Lanes::Batch;
    const F zero(0), thickness = Lanes::load(link.thickness + lane);
    F v1, v2, vt;
    l.relative(b.record[0] - a.record[0], b.record[1] - a.record[1], a.record[2], b.record[2], v1, v2, vt);
    const F speed = simd::max(simd::max(simd::abs(v1), simd::abs(v2)), simd::abs(vt)),
            slop = simd::select(speed < F(k.slow), F(k.slop) * thickness, zero);
    const auto deep = (s1 < -slop) | (s2 < -slop);
    if (!simd::any(deep)) return false;
    const LinkMass<F> mass(l, a.inverse_mass(), a.inverse_rim_mass(), b.inverse_mass(), b.inverse_rim_mass());
    const auto wanted = [&](F s) {
        return simd::select(s < zero, F(k.recovery) * simd::min(s + slop, zero), s);
    };
    F push1, push2;
    solve_two_normals(mass.k11, mass.k12, mass.k22, wanted(s1), wanted(s2), push1, push2);
    const F cap = F(k.push * k.h) * thickness;
    const auto capped = [&](F push, F inverse_mass, const Real* impulse) {
        return simd::select(deep, simd::min(push, cap / inverse_mass + F(k.h) * Lanes::load(impulse + lane)),
                            zero);
    };
    push1 = capped(push1, mass.k11, link.normal1), push2 = capped(push2, mass.k22, link.normal2);
    const F push = push1 + push2;
    near.at[0] -= a.inverse_mass() * push * l.nx, near.at[1] -= a.inverse_mass() * push * l.ny;
    far.at[0] += b.inverse_mass() * push * l.nx, far.at[1] += b.inverse_mass() * push * l.ny;
    near.turn -= a.inverse_rim_mass() * (l.near1 * push1 + l.near2 * push2);
    far.turn += b.inverse_rim_mass() * (l.far1 * push1 + l.far2 * push2);
    return true;
}

/// Floors of a substep, and a share of the overlaps taken away.
template <class Lanes, class Real>
void part_paths(const PathBatch<Real>& p) {
    using F = typename Lanes::Batch;
    const SolvePaths<Real>& k = p.k;
    const F zero(0);
    PathPlace<Lanes> near(k.displacement, k.turn, p.head);
    bool has_moved = false;  // near, by the link before
    for (std::size_t i = 0; i < p.length; ++i) {
        PathLink<Real>& link = p.link[i];
        const LinkLanes<Lanes, Real> l(link, p.lane);
        PathPlace<Lanes> far(k.displacement, k.turn, p.far_rows(i));
        F s1, s2, along;
        l.relative(far.at[0] - near.at[0], far.at[1] - near.at[1], near.turn, far.turn, s1, s2, along);
        s1 += Lanes::load(link.separation1 + p.lane), s2 += Lanes::load(link.separation2 + p.lane);
        Lanes::store(link.floor1 + p.lane, simd::min(-s1 * F(k.inverse_h), zero));
        Lanes::store(link.floor2 + p.lane, simd::min(-s2 * F(k.inverse_h), zero));
        bool moves = simd::any((s1 < zero) | (s2 < zero));
        if (moves) {
            const PathBody<Lanes> a{Lanes::load_rows4(k.velocity, p.near_rows(i))},
                b{Lanes::load_rows4(k.velocity, p.far_rows(i))};
            moves = part_bodies<Lanes>(k, link, p.lane, l, a, b, s1, s2, near, far);
        }
        if (moves || has_moved) near.store(k, p.near_rows(i));
        near = far, has_moved = moves;
    }
    if (has_moved) near.store(k, p.far_rows(p.length - 1));
}

}  // namespace
}  // namespace carom

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

/// Floors of a substep, and a share of the overlaps taken away by displacing and turning bodies.
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
        const auto deep = (s1 < zero) | (s2 < zero);
        const bool moves = simd::any(deep);
        if (moves) {
            const PathBody<Lanes> a{Lanes::load_rows4(k.velocity, p.near_rows(i))},
                b{Lanes::load_rows4(k.velocity, p.far_rows(i))};
            const LinkMass<F> mass(l, a.inverse_mass(), a.inverse_rim_mass(), b.inverse_mass(),
                                   b.inverse_rim_mass());
            const auto wanted = [&](F s) { return simd::select(s < zero, F(k.recovery) * s, s); };
            F push1, push2;
            solve_two_normals(mass.k11, mass.k12, mass.k22, wanted(s1), wanted(s2), push1, push2);
            const F cap = F(k.push * k.h) * Lanes::load(link.thickness + p.lane);
            push1 = simd::select(
                deep, simd::min(push1, cap / mass.k11 + F(k.h) * Lanes::load(link.normal1 + p.lane)), zero);
            push2 = simd::select(
                deep, simd::min(push2, cap / mass.k22 + F(k.h) * Lanes::load(link.normal2 + p.lane)), zero);
            const F push = push1 + push2;
            near.at[0] -= a.inverse_mass() * push * l.nx, near.at[1] -= a.inverse_mass() * push * l.ny;
            far.at[0] += b.inverse_mass() * push * l.nx, far.at[1] += b.inverse_mass() * push * l.ny;
            near.turn -= a.inverse_rim_mass() * (l.near1 * push1 + l.near2 * push2);
            far.turn += b.inverse_rim_mass() * (l.far1 * push1 + l.far2 * push2);
        }
        if (moves || has_moved) near.store(k, p.near_rows(i));
        near = far, has_moved = moves;
    }
    if (has_moved) near.store(k, p.far_rows(p.length - 1));
}

}  // namespace
}  // namespace carom

#pragma once

#include "kernels/contacts/contact_arguments.hpp"
#include "narrowphase/coincident.hpp"
#include "narrowphase/time_of_impact.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Gives lanes whose centres coincide a normal.
template <class Lanes, class Real>
void separate_coincident(const std::int32_t* a, const std::int32_t* b, unsigned lanes,
                         typename Lanes::Batch& nx, typename Lanes::Batch& ny) {
    alignas(64) Real x[Lanes::size], y[Lanes::size];
    Lanes::store(x, nx), Lanes::store(y, ny);
    for (std::size_t lane = 0; lane < Lanes::size; ++lane) {
        if (((lanes >> lane) & 1u) == 0) continue;
        const Vec2 n =
            normal_of_coincident(static_cast<std::uint32_t>(a[lane]), static_cast<std::uint32_t>(b[lane]));
        x[lane] = static_cast<Real>(n.x), y[lane] = static_cast<Real>(n.y);
    }
    nx = Lanes::load(x), ny = Lanes::load(y);
}

/// When two bodies come to touch, or nearest if they pass each other, within dt [s]; 0 if they touch already
/// or do not approach. The normal of that moment is the one along which their separation never falls below
/// zero before they touch.
template <class F>
F time_of_meeting(const DiscApproach<F>& discs, F dt) {
    const F zero(0), discriminant = discs.discriminant();
    const F touching = discs.time_of_impact(simd::max(discriminant, zero));
    const F t = simd::min(simd::select(discriminant > zero, touching, discs.time_of_least_distance()), dt);
    return simd::select((discs.gap > zero) & (discs.approach < zero), t, zero);
}

/// Normals and separations of contacts.
/// @return how many can touch in this step.
template <class Real, class Isa>
std::size_t find_contacts(const FindContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    std::size_t count = 0;
    for (std::size_t block = first; block < last; block += kContactBlock) {
        unsigned live_in_block = 0;
        bool is_deep = false, is_struck = false;
        for (std::size_t p = block; p < block + kContactBlock; p += Lanes::size) {
            const auto a = Lanes::load_rows4(k.motion, k.a + p);
            const auto b = Lanes::load_rows4(k.motion, k.b + p);
            const F dx = b[0] - a[0], dy = b[1] - a[1];
            const F dvx = b[2] - a[2], dvy = b[3] - a[3];
            const F reach = Lanes::load(k.reach + p);
            const F squared = dx * dx + dy * dy;
            // Each by its own speed, not by the relative one: two that fly side by side meet in this step if
            // a third body stops one of them.
            const F ways = simd::abs(a[2]) + simd::abs(a[3]) + simd::abs(b[2]) + simd::abs(b[3]);
            F at_rest = F(k.near), deep = F(k.deep), strike = F(k.strike);
            if (k.smaller) {
                const F smaller = Lanes::load(k.smaller + p);
                at_rest += F(k.near_of_smaller) * smaller, deep *= smaller, strike *= smaller;
            }
            const F flown = F(k.dt) * ways, near = reach + at_rest + flown;
            const auto is_contact = reach > F(0);
            const auto live = is_contact & (squared < near * near);
            Lanes::store(k.normal_impulse + p, simd::select(live, Lanes::load(k.normal_impulse + p), F(0)));
            Lanes::store(k.friction_impulse + p,
                         simd::select(live, Lanes::load(k.friction_impulse + p), F(0)));
            if (k.rolling_impulse)
                Lanes::store(k.rolling_impulse + p,
                             simd::select(live, Lanes::load(k.rolling_impulse + p), F(0)));
            // Bodies that are to meet in this step have the normal of the place where they meet.
            const F t = time_of_meeting(DiscApproach<F>(dx, dy, dvx, dvy, reach), F(k.dt));
            const F there_x = dx + dvx * t, there_y = dy + dvy * t;
            const F there = there_x * there_x + there_y * there_y;
            const auto coincident = there == F(0);
            const F inverse = F(1) / simd::sqrt(simd::select(coincident, F(1), there));
            F nx = there_x * inverse, ny = there_y * inverse;
            if (simd::any(coincident & is_contact))
                separate_coincident<Lanes, Real>(k.a + p, k.b + p, simd::bitmask(coincident & is_contact), nx,
                                                 ny);
            Lanes::store(k.normal_x + p, nx);
            Lanes::store(k.normal_y + p, ny);
            F separation = dx * nx + dy * ny - reach;
            if (k.pace < Real(1)) {
                const auto presses = Lanes::load(k.normal_impulse + p) > F(0);
                separation = simd::select(presses, simd::min(separation, separation * F(k.pace)), separation);
            }
            Lanes::store(k.separation + p, separation);
            is_deep |= simd::any(is_contact & (separation < deep));
            if (k.approach) Lanes::store(k.approach + p, dvx * nx + dvy * ny);
            if (k.is_struck && simd::any(flown > strike)) {
                const F way = -(dvx * nx + dvy * ny) * F(k.dt);
                is_struck |= simd::any(is_contact & (way > strike) & (way > separation));
            }
            live_in_block += static_cast<unsigned>(__builtin_popcount(simd::bitmask(live)));
        }
        k.is_live[block / kContactBlock] = is_deep ? kDeepBlock : live_in_block > 0;
        if (k.is_struck) k.is_struck[block / kContactBlock] = is_struck;
        count += live_in_block;
    }
    return count;
}

}  // namespace
}  // namespace carom

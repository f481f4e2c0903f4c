#pragma once

#include "kernels/contact_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Coincident centres have no normal: these lanes get one that depends on the rows alone.
template <class Lanes, class Real>
void separate_coincident(const std::int32_t* a, const std::int32_t* b, unsigned lanes,
                         typename Lanes::Batch& nx, typename Lanes::Batch& ny) {
    // Eight directions, by rows; (3, 4, 5) / 5 so that they are unit vectors to the last bit.
    constexpr Real kX[] = {1, Real(0.6), 0, Real(-0.8), -1, Real(-0.6), 0, Real(0.8)};
    constexpr Real kY[] = {0, Real(0.8), 1, Real(0.6), 0, Real(-0.8), -1, Real(-0.6)};
    alignas(64) Real x[Lanes::size], y[Lanes::size];
    Lanes::store(x, nx), Lanes::store(y, ny);
    for (std::size_t lane = 0; lane < Lanes::size; ++lane) {
        if (((lanes >> lane) & 1u) == 0) continue;
        const auto choice = static_cast<std::size_t>(a[lane] + 3 * b[lane]) % 8;
        x[lane] = kX[choice], y[lane] = kY[choice];
    }
    nx = Lanes::load(x), ny = Lanes::load(y);
}

/// When two bodies at relative position d, flying at relative velocity v, come to touch, or nearest if they
/// pass each other, within dt [s]; 0 if they touch already or do not approach. The normal of that moment is
/// the one along which their separation never falls below zero before they touch. Touching: the smaller root
/// of v² t² + 2 d·v t + d² - reach² = 0.
template <class F>
F time_of_meeting(F dx, F dy, F vx, F vy, F squared, F reach, F dt) {
    const F zero(0);
    const F a = vx * vx + vy * vy, b = dx * vx + dy * vy, c = squared - reach * reach;
    const F discriminant = b * b - a * c;
    const F touching = c / (simd::sqrt(simd::max(discriminant, zero)) - b);
    const F t = simd::min(simd::select(discriminant > zero, touching, -b / a), dt);
    return simd::select((c > zero) & (b < zero), t, zero);
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
        bool is_deep = false;
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
            const F near = reach + F(k.near) + F(k.dt) * ways;
            const auto is_contact = reach > F(0);
            const auto live = is_contact & (squared < near * near);
            Lanes::store(k.normal_impulse + p, simd::select(live, Lanes::load(k.normal_impulse + p), F(0)));
            Lanes::store(k.friction_impulse + p,
                         simd::select(live, Lanes::load(k.friction_impulse + p), F(0)));
            if (k.rolling_impulse)
                Lanes::store(k.rolling_impulse + p,
                             simd::select(live, Lanes::load(k.rolling_impulse + p), F(0)));
            // Bodies that are to meet in this step have the normal of the place where they meet.
            const F t = time_of_meeting(dx, dy, dvx, dvy, squared, reach, F(k.dt));
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
            const F separation = dx * nx + dy * ny - reach;
            Lanes::store(k.separation + p, separation);
            is_deep |= simd::any(is_contact & (separation < F(k.deep)));
            if (k.approach) Lanes::store(k.approach + p, dvx * nx + dvy * ny);
            live_in_block += static_cast<unsigned>(__builtin_popcount(simd::bitmask(live)));
        }
        k.is_live[block / kContactBlock] = is_deep ? kDeepBlock : live_in_block > 0;
        count += live_in_block;
    }
    return count;
}

}  // namespace
}  // namespace carom

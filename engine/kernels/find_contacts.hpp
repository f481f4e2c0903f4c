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

/// Candidates whose bodies touch or may come to touch in this step, compressed into contacts.
/// @return how many.
template <unsigned kVariant, class Real, class Isa>
std::size_t find_contacts(const FindContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    std::int32_t numbers[16];
    for (std::size_t n = 0; n < 16; ++n) numbers[n] = static_cast<std::int32_t>(first + n);
    std::size_t count = 0;
    const ContactColumns<Real>& out = k.out;
    for (std::size_t p = first; p < last; p += Lanes::size) {
        const auto a = Lanes::load_rows4(k.motion, k.a + p);
        const auto b = Lanes::load_rows4(k.motion, k.b + p);
        const auto rows_a = Lanes::load_rows(k.a + p), rows_b = Lanes::load_rows(k.b + p);
        const F dx = b[0] - a[0], dy = b[1] - a[1];
        const F dvx = b[2] - a[2], dvy = b[3] - a[3];
        F reach(k.uniform_radius + k.uniform_radius);
        if (k.radius) reach = Lanes::gather(k.radius, rows_a) + Lanes::gather(k.radius, rows_b);
        const F squared = dx * dx + dy * dy;
        const F near = reach + F(k.near) + F(k.dt) * (simd::abs(dvx) + simd::abs(dvy));
        const auto live = squared < near * near;
        const F impulse = Lanes::load(k.normal_impulse + p);
        Lanes::store(k.normal_impulse + p, simd::select(live, impulse, F(0)));
        const unsigned bits = simd::bitmask(live);
        if (bits != 0) {
            // Bodies that are to meet in this step have the normal of the place where they meet.
            const F t = time_of_meeting(dx, dy, dvx, dvy, squared, reach, F(k.dt));
            const F there_x = dx + dvx * t, there_y = dy + dvy * t;
            const F there = there_x * there_x + there_y * there_y;
            const auto coincident = there == F(0);
            const F inverse = F(1) / simd::sqrt(simd::select(coincident, F(1), there));
            F nx = there_x * inverse, ny = there_y * inverse;
            if (simd::any(coincident))
                separate_coincident<Lanes, Real>(k.a + p, k.b + p, simd::bitmask(coincident), nx, ny);
            F inverse_mass(k.uniform_inverse_mass + k.uniform_inverse_mass);
            if (k.inverse_mass)
                inverse_mass = simd::abs(Lanes::gather(k.inverse_mass, rows_a)) +
                               simd::abs(Lanes::gather(k.inverse_mass, rows_b));
            Lanes::compress_store(out.normal_x + count, nx, bits);
            Lanes::compress_store(out.normal_y + count, ny, bits);
            Lanes::compress_store(out.separation + count, dx * nx + dy * ny - reach, bits);
            Lanes::compress_store(out.mass + count, F(1) / inverse_mass, bits);
            Lanes::compress_store(out.normal_impulse + count, impulse, bits);
            if constexpr ((kVariant & kRough) != 0)
                Lanes::compress_store(out.friction_impulse + count, Lanes::load(k.friction_impulse + p),
                                      bits);
            if (k.friction)
                Lanes::compress_store(
                    out.friction + count,
                    simd::sqrt(Lanes::gather(k.friction, rows_a) * Lanes::gather(k.friction, rows_b)), bits);
            if constexpr ((kVariant & kRolling) != 0) {
                Lanes::compress_store(out.rolling_impulse + count, Lanes::load(k.rolling_impulse + p), bits);
                if (k.rolling)
                    Lanes::compress_store(
                        out.rolling + count,
                        simd::max(Lanes::gather(k.rolling, rows_a), Lanes::gather(k.rolling, rows_b)), bits);
                if (k.radius)
                    Lanes::compress_store(out.rolling_share + count, Lanes::gather(k.radius, rows_b) / reach,
                                          bits);
            }
            if (k.approach) Lanes::compress_store(k.approach + count, dvx * nx + dvy * ny, bits);
            Lanes::compress_store(out.a + count, rows_a, bits);
            Lanes::compress_store(out.b + count, rows_b, bits);
            count += Lanes::compress_store(k.candidate + count, Lanes::load_rows(numbers), bits);
        }
        for (std::int32_t& number : numbers) number += static_cast<std::int32_t>(Lanes::size);
    }
    return count;
}

}  // namespace
}  // namespace carom

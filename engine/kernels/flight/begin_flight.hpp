#pragma once

#include "kernels/flight/flight_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Whether a path from x to end, bulging by `bend`, comes nearer than `touch` to [min, max]'s ends.
template <class F>
auto reaches_wall(F x, F end, F touch, F bend, F min, F max) {
    return (simd::min(x, end) - touch - bend < min) | (simd::max(x, end) + touch + bend > max);
}

/// @tparam kListsWalls  false: the rows that may reach a wall are not asked for
template <bool kUniformRadius, bool kListsWalls, class Real, class Isa>
FlightCounts<Real> begin_flight(const BeginFlight<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F s(k.s), fall_x(k.fall_x), fall_y(k.fall_y), gain_x(k.gain_x), gain_y(k.gain_y);
    [[maybe_unused]] const F bend_x(k.bend_x), bend_y(k.bend_y), min_x(k.min_x), min_y(k.min_y),
        max_x(k.max_x), max_y(k.max_y), touch_ratio(k.touch_ratio);
    const F largest_position(k.largest_position), largest_speed(k.largest_speed);
    FlightCounts<Real> counts{0, 0, 0, 0};
    F fastest(Real(0));
    for (std::size_t i = first; i < last; i += Lanes::size) {
        const F x = Lanes::load(k.position_x + i), y = Lanes::load(k.position_y + i);
        const F vx = Lanes::load(k.velocity_x + i), vy = Lanes::load(k.velocity_y + i);
        Lanes::store_rows4(k.motion + 4 * i, kConsecutive, {{x, y, vx, vy}});

        fastest = simd::max(fastest, vx * vx + vy * vy);

        const F end_x = x + (vx * s + fall_x), end_y = y + (vy * s + fall_y);
        F radius(k.uniform_radius);
        if constexpr (!kUniformRadius) radius = Lanes::load(k.radius + i);
        unsigned wall_bits = 0;
        if constexpr (kListsWalls) {
            const F touch = radius * touch_ratio;
            wall_bits = simd::bitmask(reaches_wall(x, end_x, touch, bend_x, min_x, max_x) |
                                      reaches_wall(y, end_y, touch, bend_y, min_y, max_y));
        }

        const F moved_x = end_x - Lanes::load(k.built_x + i), moved_y = end_y - Lanes::load(k.built_y + i);
        const F margin = Lanes::load(k.reach + i) - radius;
        const auto displaced = moved_x * moved_x + moved_y * moved_y >= margin * margin;

        // Written so that NaN fails too.
        const auto kept = (simd::abs(end_x) <= largest_position) & (simd::abs(end_y) <= largest_position) &
                          (simd::abs(vx + gain_x) <= largest_speed) &
                          (simd::abs(vy + gain_y) <= largest_speed);

        const unsigned displaced_bits = simd::bitmask(displaced);
        const unsigned lost_bits = simd::bitmask(kept) ^ ((1u << Lanes::size) - 1);
        if ((wall_bits | displaced_bits | lost_bits) == 0) continue;
        const auto rows = Lanes::load_rows(kConsecutive);
        const auto list = [&](std::int32_t* out, std::size_t& count, unsigned bits) {
            const std::size_t before = count;
            count += Lanes::compress_store(out + before, rows, bits);
            for (std::size_t n = before; n < count; ++n) out[n] += static_cast<std::int32_t>(i);
        };
        if constexpr (kListsWalls) list(k.wall_rows, counts.wall, wall_bits);
        list(k.displaced_rows, counts.displaced, displaced_bits);
        list(k.lost_rows, counts.lost, lost_bits);
    }
    Real lanes[Lanes::size];
    Lanes::store_unaligned(lanes, fastest);
    for (const Real lane : lanes) counts.fastest_squared = simd::max(counts.fastest_squared, lane);
    return counts;
}

}  // namespace
}  // namespace carom

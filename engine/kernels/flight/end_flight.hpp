#pragma once

#include "kernels/flight/flight_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

template <class Real, class Isa>
void end_flight(const EndFlight<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F s(k.s), loss(k.loss), fall_x(k.fall_x), fall_y(k.fall_y), gain_x(k.gain_x), gain_y(k.gain_y);
    const F dither_x(k.dither_x), dither_y(k.dither_y);
    for (std::size_t i = first; i < last; i += Lanes::size) {
        const auto m = Lanes::load_rows4(k.motion + 4 * i, kConsecutive);
        // What is small is added up first: the sum is rounded once.
        Lanes::store(k.position_x + i, m[0] + (m[2] * s + fall_x));
        Lanes::store(k.position_y + i, m[1] + (m[3] * s + fall_y));
        Lanes::store(k.velocity_x + i, m[2] + (gain_x - m[2] * loss + simd::binade(m[2]) * dither_x));
        Lanes::store(k.velocity_y + i, m[3] + (gain_y - m[3] * loss + simd::binade(m[3]) * dither_y));
    }
}

template <class Real, class Isa>
void advance_rotation(const AdvanceRotation<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F s(k.s), u(k.u);
    for (std::size_t i = first; i < last; i += Lanes::size) {
        const F spin = Lanes::load(k.angular_velocity + i);
        Lanes::store(k.angle + i, Lanes::load(k.angle + i) + spin * s);
        Lanes::store(k.angular_velocity + i, spin * u);
    }
}

}  // namespace
}  // namespace carom

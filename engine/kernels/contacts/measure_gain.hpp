#pragma once

#include <array>

#include "kernels/contacts/contact_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"
#include "simd/ordered_lanes.hpp"

namespace carom {
namespace {

/// What the impulses of a substep have added to the kinetic energy of bodies, and what these had without
/// them; or, kWork, the work that these impulses did while gravity acted with them, by the mean of the
/// velocities at the start and at the end: less than nothing where a body lies still. Each of kContactBlock
/// partial sums takes every kContactBlock-th row, whatever the width of the lanes, so that the sums have the
/// same bits for every instruction set.
template <bool kTurns, bool kWork, class Real, class Isa>
EnergyGain measure_gain(const MeasureGain<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    using F = typename Lanes::Batch;
    constexpr std::size_t kBatches = kContactBlock / Lanes::size;
    std::array<F, kBatches> gains, energies;
    gains.fill(F(0)), energies.fill(F(0));
    const F zero(0), one(1), half(Real(0.5));
    for (std::size_t block = first; block < last; block += kContactBlock)
        for (std::size_t batch = 0; batch < kBatches; ++batch) {
            const std::size_t row = block + batch * Lanes::size;
            const auto v = Lanes::load_rows4(k.velocity + 4 * row, kConsecutive);
            const F inverse_mass = simd::abs(v[3]);
            const F mass = simd::select(inverse_mass > zero, one / inverse_mass, zero);
            const F free_x = F(k.decay) * Lanes::load(k.start.x + row) + F(k.gain_x);
            const F free_y = F(k.decay) * Lanes::load(k.start.y + row) + F(k.gain_y);
            // ½ m (v² - free²) as the change times the mean: it has no difference of large numbers.
            F before = free_x * free_x + free_y * free_y;
            const F from_x = kWork ? Lanes::load(k.start.x + row) : free_x,
                    from_y = kWork ? Lanes::load(k.start.y + row) : free_y;
            F twice = (v[0] - free_x) * (v[0] + from_x) + (v[1] - free_y) * (v[1] + from_y);
            if constexpr (kTurns) {  // the inertia is half the mass at the rim
                const F free_rim = F(k.spin_decay) * Lanes::load(k.start.rim + row);
                before += half * free_rim * free_rim;
                const F from_rim = kWork ? Lanes::load(k.start.rim + row) : free_rim;
                twice += half * ((v[2] - free_rim) * (v[2] + from_rim));
            }
            gains[batch] += half * mass * twice;
            energies[batch] += half * mass * before;
        }
    EnergyGain sum;
    alignas(64) std::array<Real, Lanes::size> lanes;
    for (std::size_t batch = 0; batch < kBatches; ++batch) {
        Lanes::store(lanes.data(), gains[batch]);
        for (const Real lane : lanes) sum.gain += static_cast<double>(lane);
        Lanes::store(lanes.data(), energies[batch]);
        for (const Real lane : lanes) sum.before += static_cast<double>(lane);
    }
    return sum;
}

}  // namespace
}  // namespace carom

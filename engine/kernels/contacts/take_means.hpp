#pragma once

#include "kernels/contacts/ordered_sum.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/ordered_lanes.hpp"

namespace carom {
namespace {

/// Mean velocities of a substep, as sum_work wants them, and what free flight did by them.
template <bool kTurns, bool kDrags, class Real, class Isa>
void take_means(const TakeMeans<Real>& k, std::size_t first, std::size_t last, FlightSums& sums) {
    using Lanes = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    using F = typename Lanes::Batch;
    using Sum = OrderedSum<Real, Isa>;
    Sum mean_x(sums.mean_x), mean_y(sums.mean_y), start_x(sums.start_x), start_y(sums.start_y);
    Sum path(sums.path), turn(sums.turn);
    const F half(Real(0.5)), zero(0);
    for (std::size_t block = first; block < last; block += kContactBlock)
        for (std::size_t batch = 0; batch < Sum::kBatches; ++batch) {
            const std::size_t row = block + batch * Lanes::size;
            auto v = Lanes::load_rows4(k.velocity + 4 * row, kConsecutive);
            const F x = Lanes::load(k.start.x + row), y = Lanes::load(k.start.y + row);
            const F of_row = k.mass ? Lanes::load(k.mass + row) : F(k.uniform_mass);
            const F mass = simd::select(simd::abs(v[3]) > zero, of_row, zero);
            v[0] = half * (x + v[0]), v[1] = half * (y + v[1]);
            mean_x.add(batch, mass * v[0]), mean_y.add(batch, mass * v[1]);
            if constexpr (kDrags) {
                start_x.add(batch, mass * x), start_y.add(batch, mass * y);
                path.add(batch, mass * (x * v[0] + y * v[1]));
            }
            if constexpr (kTurns) {
                const F rim = Lanes::load(k.start.rim + row);
                v[2] = half * (rim + v[2]);
                if constexpr (kDrags) turn.add(batch, mass * (rim * v[2]));
            }
            Lanes::store_rows4(k.mean + 4 * row, kConsecutive, v);
        }
    mean_x.store(sums.mean_x), mean_y.store(sums.mean_y);
    if constexpr (kDrags)
        start_x.store(sums.start_x), start_y.store(sums.start_y), path.store(sums.path),
            turn.store(sums.turn);
}

}  // namespace
}  // namespace carom

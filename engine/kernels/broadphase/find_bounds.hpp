#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "simd/lanes.hpp"

#include <limits>

namespace carom {
namespace {

template <class L, class Real>
void widen_bounds(const FindBounds<Real>& k, std::size_t first, std::size_t last, Real (&low)[3],
                  Real (&high)[3]) {
    const Real* columns[3] = {k.x, k.y, k.reach};
    for (int c = 0; c < 3; ++c) {
        auto smallest = L::broadcast(low[c]), largest = L::broadcast(high[c]);
        for (std::size_t i = first; i < last; i += L::size) {
            const auto value = L::load(columns[c] + i);
            smallest = simd::min(value, smallest);  // in this order NaN leaves the bound alone
            largest = simd::max(value, largest);
        }
        alignas(64) Real lanes[2][L::size];
        L::store(lanes[0], smallest);
        L::store(lanes[1], largest);
        for (std::size_t lane = 0; lane < L::size; ++lane) {
            low[c] = simd::min(lanes[0][lane], low[c]);
            high[c] = simd::max(lanes[1][lane], high[c]);
        }
    }
}

template <class Real, class Isa>
void find_bounds(FindBounds<Real>& k) {
    using L = simd::Lanes<Real, Isa>;
    constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
    Real low[3] = {kInfinity, kInfinity, kInfinity};
    Real high[3] = {-kInfinity, -kInfinity, -kInfinity};
    const std::size_t whole = k.rows - k.rows % L::size;
    widen_bounds<L>(k, 0, whole, low, high);
    widen_bounds<simd::Lanes<Real, simd::Scalar>>(k, whole, k.rows, low, high);  // padding is not a position
    k.min_x = low[0], k.min_y = low[1], k.min_reach = low[2];
    k.max_x = high[0], k.max_y = high[1], k.max_reach = high[2];
}

}  // namespace
}  // namespace carom

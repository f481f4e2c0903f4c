#pragma once

#include "kernels/paths/path_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Tells of the rows first ... last which are thrown.
/// @return whether one is
/// @see FindThrown
template <class Real, class Isa>
bool find_thrown(const FindThrown<Real>& k, std::size_t first, std::size_t last) {
    using L = simd::Lanes<Real, Isa>;
    using F = typename L::Batch;
    using simd::abs;
    unsigned any = 0;
    for (std::size_t row = first; row < last; row += L::size) {
        const auto now = L::load_rows4(k.velocity + 4 * row, kConsecutive);
        const F speed = abs(now[0]) + abs(now[1]) + abs(now[2]);
        F before = abs(L::load(k.start.x + row)) + abs(L::load(k.start.y + row));
        if (k.start.rim) before += abs(L::load(k.start.rim + row));
        const F inradius = k.inradius ? L::load(k.inradius + row) : F(k.uniform_inradius);
        auto is_thrown = speed > F(k.times) * (before + F(k.fall)) + F(k.none) * inradius;
        if (k.joined) is_thrown = is_thrown & !(L::load(k.joined + row) > F(0));
        const auto bits = static_cast<unsigned>(simd::bitmask(is_thrown));
        any |= bits;
        for (std::size_t lane = 0; lane < L::size; ++lane)
            k.is_thrown[row + lane] = static_cast<std::uint8_t>(1 & (bits >> lane));
    }
    return any != 0;
}

}  // namespace
}  // namespace carom

#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Cell coordinate of a position along one axis, whole, in [low, high].
template <class L>
typename L::Batch cell_coordinate(typename L::Batch position, double inverse_size, double low, double high) {
    const auto scaled = position * L::broadcast(inverse_size);
    const auto above = simd::max(scaled, L::broadcast(low));  // in this order NaN becomes low
    return L::floor(simd::min(above, L::broadcast(high)));
}

/// value mod cells; value whole; |value| < 2^52 and |value / cells| < 2^31.
template <class L>
typename L::Batch wrapped(typename L::Batch value, const CellNumbering& numbering) {
    const auto cells = L::broadcast(numbering.cells), zero = L::broadcast(0.0);
    const auto quotient = L::floor(value * L::broadcast(numbering.inverse_cells));
    const auto remainder = value - quotient * cells;  // exact; the quotient may be one off
    const auto from_below = simd::select(remainder < zero, remainder + cells, remainder);
    return simd::select(from_below >= cells, from_below - cells, from_below);
}

/// The number of the cell that the positions lie in.
template <class L, bool kWraps>
typename L::Batch cell_number(typename L::Batch x, typename L::Batch y, const CellNumbering& numbering) {
    const auto u = cell_coordinate<L>(x, numbering.inverse_size, numbering.low_u, numbering.high_u);
    const auto v = cell_coordinate<L>(y, numbering.inverse_size, numbering.low_v, numbering.high_v);
    const auto column = u - L::broadcast(numbering.low_u), line = v - L::broadcast(numbering.low_v);
    const auto width = L::broadcast(numbering.width);
    if constexpr (kWraps)
        return wrapped<L>(column + width * wrapped<L>(line, numbering), numbering);
    else
        return column + width * line;
}

template <class Real, class L, bool kWraps>
void find_cells_numbered(const FindCells<Real>& k) {
    for (std::size_t i = 0; i < k.rows; i += L::size) {
        const auto number =
            cell_number<L, kWraps>(L::load_converted(k.x + i), L::load_converted(k.y + i), k.numbering);
        L::store_rows(k.cell_out + i, L::floor_to_rows(number));
    }
}

template <class Real, class Isa>
void find_cells(const FindCells<Real>& k) {
    using L = simd::Lanes<double, Isa>;
    if (k.numbering.wraps)
        find_cells_numbered<Real, L, true>(k);
    else
        find_cells_numbered<Real, L, false>(k);
}

}  // namespace
}  // namespace carom

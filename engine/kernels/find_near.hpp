#pragma once

#include "kernels/find_cells.hpp"
#include "kernels/scan_range.hpp"

namespace carom {
namespace {

/// The number of the cell of a query, or of a neighbouring one if rounding decides: cells are large enough
/// for that.
template <class Real>
std::int32_t query_cell(const GridLevel<Real>& level, Real x, Real y) {
    using One = simd::Lanes<double, simd::Scalar>;
    const CellNumbering& n = level.numbering;
    const double wide_x = static_cast<double>(x), wide_y = static_cast<double>(y);
    if (n.wraps) return static_cast<std::int32_t>(cell_number<One, true>(wide_x, wide_y, n));
    const auto cells_from = [&](double position, double low, double high) {
        const double cells = simd::max(position * n.inverse_size - low, 0.0);
        return static_cast<std::int32_t>(simd::min(cells, high - low));
    };
    return cells_from(wide_x, n.low_u, n.high_u) + level.width * cells_from(wide_y, n.low_v, n.high_v);
}

/// Writes the rows of the bodies near the query at places [first, last) to k.out + count; returns the new
/// count.
template <class L, class Real>
std::size_t append_near(const SortedBodies<Real>& bodies, std::int32_t first, std::int32_t last,
                        const FindNear<Real>& k, std::size_t count) {
    const Probe<L> probe{L::broadcast(k.x), L::broadcast(k.y), L::broadcast(k.reach)};
    scan_range<L>(bodies, static_cast<std::size_t>(first), static_cast<std::size_t>(last), probe,
                  [&](std::size_t at, unsigned lanes) {
                      count += L::compress_store(k.out + count, L::load_rows(bodies.row + at), lanes);
                  });
    return count;
}

/// Any three rows of three cells; the last cell and the first may lie between.
template <class L, class Real>
std::size_t find_near_in_rows(const GridLevel<Real>& level, const std::int32_t (&first_cell)[3],
                              const FindNear<Real>& k) {
    const std::int32_t* begin = level.bodies.cell_begin;
    std::size_t count = 0;
    for (const std::int32_t first : first_cell) {
        const std::int32_t last = first + 3 < level.cells ? first + 3 : level.cells;
        const std::int32_t rest = first + 3 - last;
        if (count + static_cast<std::size_t>(begin[last] - begin[first] + begin[rest]) + L::size > k.capacity)
            return kNoRoom;
        count = append_near<L>(level.bodies, begin[first], begin[last], k, count);
        if (rest > 0) count = append_near<L>(level.bodies, begin[0], begin[rest], k, count);
    }
    return count;
}

/// The 3 x 3 cells around the query. Rows that fit a batch, which nearly all do, take no branch.
template <class Real, class L>
std::size_t find_near_in_block(const GridLevel<Real>& level, const FindNear<Real>& k) {
    const std::int32_t cell = query_cell(level, k.x, k.y), cells = level.cells;
    const std::int32_t below = cell - level.width - 1, own = cell - 1, above = cell + level.width - 1;
    const std::int32_t first_cell[3] = {below < 0 ? below + cells : below, own < 0 ? own + cells : own,
                                        above >= cells ? above - cells : above};
    const SortedBodies<Real>& bodies = level.bodies;
    std::size_t first[3], count[3];
    bool is_usual = k.capacity >= 4 * L::size;
    for (int i = 0; i < 3; ++i) {
        const std::int32_t* begin = bodies.cell_begin + first_cell[i];
        first[i] = static_cast<std::size_t>(begin[0]);
        count[i] = static_cast<std::size_t>(begin[3]) - first[i];
        is_usual = is_usual & (first_cell[i] + 3 <= cells) & (count[i] <= L::size);
    }
    if (!is_usual || L::size == 1) return find_near_in_rows<L>(level, first_cell, k);

    const Probe<L> probe{L::broadcast(k.x), L::broadcast(k.y), L::broadcast(k.reach)};
    std::size_t found = 0;
    for (int i = 0; i < 3; ++i) {
        const unsigned near = near_lanes<L>(bodies, first[i], probe) & ((1u << count[i]) - 1u);
        found += L::compress_store(k.out + found, L::load_rows(bodies.row + first[i]), near);
    }
    return found;
}

/// A query larger than a cell: all cells that it touches, or the whole level if cells share numbers.
template <class Real, class L>
std::size_t find_near_in_box(const GridLevel<Real>& level, const FindNear<Real>& k) {
    if (level.places + L::size > k.capacity) return kNoRoom;
    if (level.numbering.wraps)
        return append_near<L>(level.bodies, 0, static_cast<std::int32_t>(level.places), k, 0);

    constexpr double kRoundingMargin = 1 + 1e-5;
    const double reach =
        (static_cast<double>(k.reach) + static_cast<double>(level.largest_reach)) * kRoundingMargin;
    const CellNumbering& n = level.numbering;
    const auto cell = [&](double position, double low, double high) {
        using One = simd::Lanes<double, simd::Scalar>;
        return static_cast<std::int32_t>(cell_coordinate<One>(position, n.inverse_size, low, high) - low);
    };
    const double x = static_cast<double>(k.x), y = static_cast<double>(k.y);
    const std::int32_t left = cell(x - reach, n.low_u, n.high_u), right = cell(x + reach, n.low_u, n.high_u);
    const std::int32_t bottom = cell(y - reach, n.low_v, n.high_v), top = cell(y + reach, n.low_v, n.high_v);
    std::size_t count = 0;
    for (std::int32_t line = bottom; line <= top; ++line) {
        const std::int32_t* begin = level.bodies.cell_begin + line * level.width;
        count = append_near<L>(level.bodies, begin[left], begin[right + 1], k, count);
    }
    return count;
}

/// Returns how many rows it wrote to out; or kNoRoom.
template <class Real, class Isa>
std::size_t find_near(const GridLevel<Real>& level, const FindNear<Real>& k) {
    using L = simd::ShortLanes<Real, Isa>;
    if (k.reach <= level.largest_reach) return find_near_in_block<Real, L>(level, k);
    return find_near_in_box<Real, L>(level, k);
}

}  // namespace
}  // namespace carom

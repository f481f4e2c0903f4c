#pragma once

#include "kernels/broadphase/find_cells.hpp"
#include "kernels/broadphase/scan_range.hpp"

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

/// Writes the rows of those bodies of a range that are near a probe.
template <class L, class Real>
struct PickNear {
    const SortedBodies<Real>& bodies;
    Probe<L> probe;

    /// Of `count` <= L::size places; returns how many it wrote, with room for a batch.
    std::size_t operator()(std::size_t place, std::size_t count, std::int32_t* out) const {
        const unsigned near = near_lanes<L>(bodies, place, probe) & ((1u << count) - 1u);
        return L::compress_store(out, L::load_rows(bodies.row + place), near);
    }
};

/// Picks from places [first, last) to out + count; returns the new count. The usual range fits one batch, so
/// that the loop is not entered; an empty range costs the same.
template <class L, class Pick>
std::size_t pick_from(std::int32_t first, std::int32_t last, const Pick& pick, std::int32_t* out,
                      std::size_t count) {
    auto place = static_cast<std::size_t>(first);
    const auto end = static_cast<std::size_t>(last);
    while (end - place > L::size) {
        count += pick(place, L::size, out + count);
        place += L::size;
    }
    return count + pick(place, end - place, out + count);
}

/// Any three rows of three cells; the last cell and the first may lie between.
template <class L, class Real, class Pick>
std::size_t pick_in_rows(const GridLevel<Real>& level, const std::int32_t (&first_cell)[3],
                         const FindNear<Real>& k, const Pick& pick) {
    const std::int32_t* begin = level.bodies.cell_begin;
    std::size_t count = 0;
    for (const std::int32_t first : first_cell) {
        const std::int32_t last = first + 3 < level.cells ? first + 3 : level.cells;
        const std::int32_t rest = first + 3 - last;
        if (count + static_cast<std::size_t>(begin[last] - begin[first] + begin[rest]) + L::size > k.capacity)
            return kNoRoom;
        count = pick_from<L>(begin[first], begin[last], pick, k.out, count);
        if (rest > 0) count = pick_from<L>(begin[0], begin[rest], pick, k.out, count);
    }
    return count;
}

/// The 3 x 3 cells around the query. Rows that fit a batch, which nearly all do, take no branch.
template <class L, class Real, class Pick>
std::size_t pick_in_block(const GridLevel<Real>& level, const FindNear<Real>& k, const Pick& pick) {
    const std::int32_t cell = query_cell(level, k.x, k.y), cells = level.cells;
    const std::int32_t below = cell - level.width - 1, own = cell - 1, above = cell + level.width - 1;
    const std::int32_t first_cell[3] = {below < 0 ? below + cells : below, own < 0 ? own + cells : own,
                                        above >= cells ? above - cells : above};
    std::size_t first[3], count[3];
    bool is_usual = k.capacity >= 4 * L::size;
    for (int i = 0; i < 3; ++i) {
        const std::int32_t* begin = level.bodies.cell_begin + first_cell[i];
        first[i] = static_cast<std::size_t>(begin[0]);
        count[i] = static_cast<std::size_t>(begin[3]) - first[i];
        is_usual = is_usual & (first_cell[i] + 3 <= cells) & (count[i] <= L::size);
    }
    if (!is_usual || L::size == 1) return pick_in_rows<L>(level, first_cell, k, pick);

    std::size_t found = 0;
    for (int i = 0; i < 3; ++i) found += pick(first[i], count[i], k.out + found);
    return found;
}

/// A query larger than a cell: all cells that it touches, or the whole level if cells share numbers.
template <class L, class Real, class Pick>
std::size_t pick_in_box(const GridLevel<Real>& level, const FindNear<Real>& k, const Pick& pick) {
    if (level.numbering.wraps) {
        if (level.places + L::size > k.capacity) return kNoRoom;
        return pick_from<L>(0, static_cast<std::int32_t>(level.places), pick, k.out, 0);
    }
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
        if (count + static_cast<std::size_t>(begin[right + 1] - begin[left]) + L::size > k.capacity)
            return kNoRoom;
        count = pick_from<L>(begin[left], begin[right + 1], pick, k.out, count);
    }
    return count;
}

/// Picks from all cells in which a body can be that is near the query; returns how many rows it wrote to
/// out, or kNoRoom.
template <class L, class Real, class Pick>
std::size_t pick_around(const GridLevel<Real>& level, const FindNear<Real>& k, const Pick& pick) {
    if (k.reach <= level.largest_reach) return pick_in_block<L>(level, k, pick);
    return pick_in_box<L>(level, k, pick);
}

template <class Real, class Isa>
std::size_t find_near(const GridLevel<Real>& level, const FindNear<Real>& k) {
    using L = simd::ShortLanes<Real, Isa>;
    const Probe<L> probe{L::broadcast(k.x), L::broadcast(k.y), L::broadcast(k.reach)};
    return pick_around<L>(level, k, PickNear<L, Real>{level.bodies, probe});
}

}  // namespace
}  // namespace carom

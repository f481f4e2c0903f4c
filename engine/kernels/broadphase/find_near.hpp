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

    /// Writes the rows of those that are near of `count` <= L::size places; `out` has room for a batch.
    /// @return how many it wrote
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

/// Cells that a query touches, as coordinates from the lowest of the level.
struct CellBox {
    double left, right, bottom, top;
};
template <class Real>
CellBox cells_around(const GridLevel<Real>& level, const FindNear<Real>& k) {
    constexpr double kRoundingMargin = 1 + 1e-5;  // more than sums of a few floats are off by
    const double reach =
        (static_cast<double>(k.reach) + static_cast<double>(level.largest_reach)) * kRoundingMargin;
    const CellNumbering& n = level.numbering;
    const auto cell = [&](double position, double low, double high) {
        using One = simd::Lanes<double, simd::Scalar>;
        return cell_coordinate<One>(position, n.inverse_size, low, high) - low;
    };
    const double x = static_cast<double>(k.x), y = static_cast<double>(k.y);
    return {cell(x - reach, n.low_u, n.high_u), cell(x + reach, n.low_u, n.high_u),
            cell(y - reach, n.low_v, n.high_v), cell(y + reach, n.low_v, n.high_v)};
}

/// Picks from cells [first, last), after `count` that were; returns the new count, or kNoRoom.
template <class L, class Real, class Pick>
std::size_t pick_in_cells(const GridLevel<Real>& level, std::size_t first, std::size_t last,
                          const FindNear<Real>& k, const Pick& pick, std::size_t count) {
    const std::int32_t begin = level.bodies.cell_begin[first], end = level.bodies.cell_begin[last];
    if (count + static_cast<std::size_t>(end - begin) + L::size > k.capacity) return kNoRoom;
    return pick_from<L>(begin, end, pick, k.out, count);
}

/// A query larger than a cell where cells share numbers: the lines of cells that it touches, each number
/// once, or the whole level where that is hardly more.
template <class L, class Real, class Pick>
std::size_t pick_in_folded_box(const GridLevel<Real>& level, const FindNear<Real>& k, const Pick& pick) {
    constexpr std::size_t kMostLines = 32;  // with more the sorted list of runs would take long
    using One = simd::Lanes<double, simd::Scalar>;
    const CellNumbering& n = level.numbering;
    const CellBox box = cells_around(level, k);
    const double columns = box.right - box.left + 1, lines = box.top - box.bottom + 1;
    if (!(lines <= static_cast<double>(kMostLines)) || !(2 * lines * columns <= n.cells))
        return pick_in_cells<L>(level, 0, static_cast<std::size_t>(level.cells), k, pick, 0);
    struct Run {
        std::size_t first, last;
    } runs[2 * kMostLines];  // of numbers, ascending
    std::size_t run_count = 0;
    const auto add = [&](std::size_t first, std::size_t last) {
        std::size_t at = run_count++;
        for (; at > 0 && runs[at - 1].first > first; --at) runs[at] = runs[at - 1];
        runs[at] = {first, last};
    };
    const auto cells = static_cast<std::size_t>(level.cells);
    for (double line = box.bottom; line <= box.top; ++line) {
        const auto first =
            static_cast<std::size_t>(wrapped<One>(box.left + n.width * wrapped<One>(line, n), n));
        const std::size_t last = first + static_cast<std::size_t>(columns);
        add(first, last < cells ? last : cells);
        if (last > cells) add(0, last - cells);
    }
    std::size_t count = 0, done = 0;  // numbers below it are
    for (std::size_t i = 0; i < run_count && count != kNoRoom; ++i) {
        const std::size_t first = runs[i].first < done ? done : runs[i].first;
        if (runs[i].last <= first) continue;
        count = pick_in_cells<L>(level, first, runs[i].last, k, pick, count);
        done = runs[i].last;
    }
    return count;
}

/// A query larger than a cell: all cells that it touches.
template <class L, class Real, class Pick>
std::size_t pick_in_box(const GridLevel<Real>& level, const FindNear<Real>& k, const Pick& pick) {
    if (level.numbering.wraps) return pick_in_folded_box<L>(level, k, pick);
    const CellBox box = cells_around(level, k);
    const auto width = static_cast<std::size_t>(level.width), left = static_cast<std::size_t>(box.left),
               right = static_cast<std::size_t>(box.right), top = static_cast<std::size_t>(box.top);
    std::size_t count = 0;
    for (auto line = static_cast<std::size_t>(box.bottom); line <= top && count != kNoRoom; ++line)
        count = pick_in_cells<L>(level, line * width + left, line * width + right + 1, k, pick, count);
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

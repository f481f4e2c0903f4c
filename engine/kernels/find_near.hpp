#pragma once

#include "kernels/find_cells.hpp"
#include "kernels/scan_range.hpp"

namespace carom {
namespace {

/// The bodies of consecutive places.
struct Places {
    std::size_t first, last;
    std::size_t count() const { return last - first; }
};

/// Writes the rows of the bodies near the query among those places to k.out + count; returns the new count.
template <class L, class Real>
std::size_t append_near(const SortedBodies<Real>& bodies, Places places, const FindNear<Real>& k,
                        std::size_t count) {
    const Probe<L> probe{L::broadcast(k.x), L::broadcast(k.y), L::broadcast(k.reach)};
    scan_range<L>(bodies, places.first, places.last, probe, [&](std::size_t at, unsigned lanes) {
        count += L::compress_store(k.out + count, L::load_rows(bodies.row + at), lanes);
    });
    return count;
}

/// The places of three consecutive cells: one stretch, or two where numbers wrap around.
struct CellRow {
    Places places, rest;
};

template <class Real>
CellRow three_cells(const GridLevel<Real>& level, std::int32_t first) {
    const std::int32_t* begin = level.bodies.cell_begin;
    const auto places = [&](std::int32_t from, std::int32_t to) {
        return Places{static_cast<std::size_t>(begin[from]), static_cast<std::size_t>(begin[to])};
    };
    if (first >= 0 && first + 3 <= level.cells) return {places(first, first + 3), {0, 0}};
    if (first < 0) first += level.cells;
    if (first >= level.cells) first -= level.cells;
    if (first + 3 <= level.cells) return {places(first, first + 3), {0, 0}};
    return {places(first, level.cells), places(0, first + 3 - level.cells)};
}

/// Those of the 3 x 3 cells around the query.
template <class Real, class L>
std::size_t find_near_in_block(const GridLevel<Real>& level, const FindNear<Real>& k) {
    using One = simd::Lanes<double, simd::Scalar>;
    const double x = static_cast<double>(k.x), y = static_cast<double>(k.y);
    const CellNumbering& numbering = level.numbering;
    const auto cell = static_cast<std::int32_t>(numbering.wraps ? cell_number<One, true>(x, y, numbering)
                                                                : cell_number<One, false>(x, y, numbering));
    const CellRow rows[3] = {three_cells(level, cell - level.width - 1), three_cells(level, cell - 1),
                             three_cells(level, cell + level.width - 1)};
    std::size_t most = L::size;
    for (const CellRow& row : rows) most += row.places.count() + row.rest.count();
    if (most > k.capacity) return kNoRoom;
    std::size_t count = 0;
    for (const CellRow& row : rows) {
        count = append_near<L>(level.bodies, row.places, k, count);
        if (row.rest.count() > 0) count = append_near<L>(level.bodies, row.rest, k, count);
    }
    return count;
}

/// A query larger than a cell: all cells that it touches, or the whole level if cells share numbers.
template <class Real, class L>
std::size_t find_near_in_box(const GridLevel<Real>& level, const FindNear<Real>& k) {
    using One = simd::Lanes<double, simd::Scalar>;
    if (level.places + L::size > k.capacity) return kNoRoom;
    if (level.numbering.wraps) return append_near<L>(level.bodies, {0, level.places}, k, 0);

    constexpr double kRoundingMargin = 1 + 1e-5;
    const double reach =
        (static_cast<double>(k.reach) + static_cast<double>(level.largest_reach)) * kRoundingMargin;
    const CellNumbering& n = level.numbering;
    const auto cell = [&](double position, double low, double high) {
        return static_cast<std::int32_t>(cell_coordinate<One>(position, n.inverse_size, low, high) - low);
    };
    const double x = static_cast<double>(k.x), y = static_cast<double>(k.y);
    const std::int32_t left = cell(x - reach, n.low_u, n.high_u), right = cell(x + reach, n.low_u, n.high_u);
    const std::int32_t bottom = cell(y - reach, n.low_v, n.high_v), top = cell(y + reach, n.low_v, n.high_v);
    std::size_t count = 0;
    for (std::int32_t line = bottom; line <= top; ++line) {
        const std::int32_t* begin = level.bodies.cell_begin + line * level.width;
        count = append_near<L>(
            level.bodies, {static_cast<std::size_t>(begin[left]), static_cast<std::size_t>(begin[right + 1])},
            k, count);
    }
    return count;
}

/// Returns how many rows it wrote to out, which has room for kRowPadding more than that; or kNoRoom.
template <class Real, class Isa>
std::size_t find_near(const GridLevel<Real>& level, const FindNear<Real>& k) {
    using L = simd::Lanes<Real, Isa>;
    if (k.reach <= level.largest_reach) return find_near_in_block<Real, L>(level, k);
    return find_near_in_box<Real, L>(level, k);
}

}  // namespace
}  // namespace carom

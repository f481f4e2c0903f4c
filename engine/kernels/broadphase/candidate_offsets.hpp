#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"
#include "simd/lanes.hpp"

#include <limits>

namespace carom {
namespace {

/// Bodies are taken in blocks of so many places, on every instruction set: the order of pairs depends on it.
constexpr std::size_t kBlockPlaces = 16;

constexpr std::int32_t kOffsetsPerWord = 64 / static_cast<std::int32_t>(kBlockPlaces);

constexpr std::int32_t kNowhere = std::numeric_limits<std::int32_t>::max() / 2;

/// Distances in places, [first, last).
struct Offsets {
    std::int32_t first = kNowhere, last = kNowhere;
    std::int32_t count() const { return last - first; }
};

/// Where the bodies of one block have neighbours of higher place: in the own row of cells and the next, and
/// where the plane wraps in two more. Disjoint and ascending, so that each offset is visited once.
template <bool kWraps>
struct BlockOffsets {
    static constexpr int kRows = kWraps ? 4 : 2;
    Offsets rows[kRows];

    std::int32_t count() const {
        std::int32_t sum = 0;
        for (const Offsets& row : rows) sum += row.count();
        return sum;
    }
};

/// Bounds over the cells c in [first_cell, last_cell] of
///   the end of the own row, begin(c + 2) - begin(c), and
///   the row of three cells from c + ahead on: from begin(c + ahead) - begin(c + 1) + 1 to begin(c + ahead +
///   3) - begin(c).
/// May be too wide, for it looks at cells after last_cell too: offsets where nothing is near only cost time.
struct RowBounds {
    std::int32_t own_last;
    Offsets row;
};

template <class Isa>
RowBounds row_bounds(const std::int32_t* cell_begin, std::int32_t first_cell, std::int32_t last_cell,
                     std::int32_t ahead) {
    using L = simd::Lanes<float, Isa>;
    constexpr auto kLanes = static_cast<std::int32_t>(L::size);
    constexpr std::int32_t kCells =
        16;  // in one go; two cover most blocks without a branch that depends on them
    auto own = L::broadcast_row(0), low = L::broadcast_row(std::numeric_limits<std::int32_t>::max()),
         high = own;
    const auto widen = [&](std::int32_t from_cell) {
        for (std::int32_t cell = from_cell; cell < from_cell + kCells; cell += kLanes) {
            const std::int32_t *from = cell_begin + cell, *to = from + ahead;
            const auto begin = L::load_rows(from);
            own = L::rows_min(own, L::rows_difference(begin, L::load_rows(from + 2)));
            low = L::rows_min(low, L::rows_difference(L::load_rows(to), L::load_rows(from + 1)));
            high = L::rows_min(high, L::rows_difference(begin, L::load_rows(to + 3)));
        }
    };
    widen(first_cell);
    for (std::int32_t cell = first_cell + kCells; cell < last_cell - kCells; cell += kCells) widen(cell);
    widen(last_cell - kCells + 1 > first_cell ? last_cell - kCells + 1 : first_cell);

    std::int32_t smallest[4];
    L::store_smallest4(smallest, own, low, high, high);
    return {-smallest[0], {smallest[1] + 1, -smallest[2]}};
}

/// Makes ascending rows disjoint, from offset 1 to `highest`, and as long as whole words of the kernel: the
/// offsets beyond `highest` lead to the places after the last body.
template <bool kWraps>
void visit_once(BlockOffsets<kWraps>& offsets, std::int32_t highest) {
    std::int32_t next = 1;
    for (Offsets& row : offsets.rows) {
        const std::int32_t first = row.first > next ? row.first : next;
        const std::int32_t last = row.last < highest + 1 ? row.last : highest + 1;
        const std::int32_t count = last > first ? last - first : 0;
        next = first + (count + kOffsetsPerWord - 1) / kOffsetsPerWord * kOffsetsPerWord;
        row = {first, next};
    }
}

inline void sort_by_first(BlockOffsets<true>& offsets) {
    for (int i = 1; i < 4; ++i)
        for (int at = i; at > 0 && offsets.rows[at].first < offsets.rows[at - 1].first; --at) {
            const Offsets lower = offsets.rows[at];
            offsets.rows[at] = offsets.rows[at - 1];
            offsets.rows[at - 1] = lower;
        }
}

/// The offsets to visit for the bodies at places [place, place + kBlockPlaces). A pair of neighbours is found
/// from its lower place: where the plane wraps, the rows below and to the left of the first cells have the
/// higher places, so those are visited too.
template <class Isa, bool kWraps, class Real>
BlockOffsets<kWraps> block_offsets(const GridLevel<Real>& level, std::size_t place) {
    const SortedBodies<Real>& bodies = level.bodies;
    const std::size_t end = place + kBlockPlaces < level.places ? place + kBlockPlaces : level.places;
    const std::int32_t first_cell = bodies.cell[place], last_cell = bodies.cell[end - 1];

    BlockOffsets<kWraps> offsets;
    const RowBounds above = row_bounds<Isa>(bodies.cell_begin, first_cell, last_cell, level.width - 1);
    offsets.rows[0] = {1, above.own_last};
    offsets.rows[1] = above.row;
    if constexpr (kWraps) {
        const std::int32_t last_below = last_cell < level.width ? last_cell : level.width;
        if (first_cell <= level.width)
            offsets.rows[2] =
                row_bounds<Isa>(bodies.cell_begin, first_cell, last_below, level.cells - level.width - 1).row;
        if (first_cell == 0) offsets.rows[3] = row_bounds<Isa>(bodies.cell_begin, 0, 0, level.cells - 1).row;
        sort_by_first(offsets);
    }
    visit_once(offsets, static_cast<std::int32_t>(level.places - 1 - place));
    return offsets;
}

/// The same for one body, exactly its own.
template <bool kWraps, class Real>
BlockOffsets<kWraps> body_offsets(const GridLevel<Real>& level, std::size_t place) {
    const auto own_place = static_cast<std::int32_t>(place);
    const std::int32_t cell = level.bodies.cell[place];
    const std::int32_t* begin = level.bodies.cell_begin + cell;
    const auto row = [&](std::int32_t ahead) {
        return Offsets{begin[ahead] - own_place, begin[ahead + 3] - own_place};
    };
    BlockOffsets<kWraps> offsets;
    offsets.rows[0] = {1, begin[2] - own_place};
    offsets.rows[1] = row(level.width - 1);
    if constexpr (kWraps) {
        if (cell <= level.width) offsets.rows[2] = row(level.cells - level.width - 1);
        if (cell == 0) offsets.rows[3] = row(level.cells - 1);
        sort_by_first(offsets);
    }
    visit_once(offsets, static_cast<std::int32_t>(level.places) - 1 - own_place);
    return offsets;
}

}  // namespace
}  // namespace carom

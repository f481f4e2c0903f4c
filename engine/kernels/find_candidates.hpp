#pragma once

#include "kernels/scan_range.hpp"

namespace carom {
namespace {

/// Returns the place it has come to: k.last, or less if a and b have no room for the next body's pairs.
/// Each body is held against the rest of its row of cells up to the next cell, and three cells of the next
/// row.
template <class Real, class Isa>
std::size_t find_candidates(FindCandidates<Real>& k) {
    using L = simd::Lanes<Real, Isa>;
    const SortedBodies<Real> bodies = k.level->bodies;
    const std::int32_t width = k.level->width, cells = k.level->cells;
    std::size_t count = k.count, place = k.first;
    for (; place < k.last; ++place) {
        const std::int32_t cell = bodies.cell[place];
        const std::int32_t above = cell + width - 1;
        const std::int32_t* next_row = bodies.cell_begin + (above >= cells ? above - cells : above);
        const auto own_last = static_cast<std::size_t>(bodies.cell_begin[cell + 2]);
        const auto next_first = static_cast<std::size_t>(next_row[0]);
        const auto next_last = static_cast<std::size_t>(next_row[3]);
        if (count + (own_last - place) + (next_last - next_first) + 2 * L::size > k.capacity) break;

        const Probe<L> probe{L::broadcast(bodies.x[place]), L::broadcast(bodies.y[place]),
                             L::broadcast(bodies.reach[place])};
        const auto row = L::broadcast_row(bodies.row[place]);
        const auto keep = [&](std::size_t at, unsigned lanes) {
            L::store_rows(k.a + count, row);
            count += L::compress_store(k.b + count, L::load_rows(bodies.row + at), lanes);
        };
        scan_range<L>(bodies, place + 1, own_last, probe, keep);
        scan_range<L>(bodies, next_first, next_last, probe, keep);
    }
    k.count = count;
    return place;
}

}  // namespace
}  // namespace carom

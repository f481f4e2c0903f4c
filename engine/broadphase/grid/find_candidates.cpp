#include "broadphase/grid/uniform_grid.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

constexpr std::size_t kPlacesPerChunk = kRowsPerChunk;  // whole blocks of the kernel
constexpr double kNanosecondsToCopy = 0.3;              // a pair, on one thread, for the executor

void make_room(CandidatePairs& pairs, std::size_t wanted) {
    if (pairs.a.size() >= wanted) return;
    const std::size_t rows = std::max(wanted, 2 * pairs.a.size());
    pairs.a.resize(rows);
    pairs.b.resize(rows);
}

/// Appends the pairs of places [first, last).
template <class Real>
void append_pairs(const KernelTable<Real>& kernels, const GridLevel<Real>& level, std::size_t first,
                  std::size_t last, CandidatePairs& pairs) {
    make_room(pairs, pairs.count + 2 * (last - first) + 4 * kRowPadding);
    for (;;) {
        FindCandidates<Real> k{&level,         first,          last,       pairs.a.data(),
                               pairs.b.data(), pairs.a.size(), pairs.count};
        first = kernels.find_candidates(k);
        pairs.count = k.count;
        if (first == last) return;
        make_room(pairs, 2 * pairs.a.size());
    }
}

}  // namespace

template <class Real>
const CandidatePairs& UniformGrid<Real>::find_candidates(const Executor& executor) {
    pairs_.count = 0;
    for (std::size_t level = 0; level < moving_.count; ++level) find_in_level(moving_[level], executor);
    for (std::size_t coarse = 0; coarse < moving_.count; ++coarse)
        for (std::size_t fine = coarse + 1; fine < moving_.count; ++fine)
            find_across(moving_[coarse], moving_[fine]);
    for (std::size_t level = 0; level < moving_.count; ++level)
        for (std::size_t other = 0; other < standing_.count; ++other)
            look_at_standing(standing_[other], moving_[level]);
    if (has_immovable_) drop_immovable_pairs();
    pad_pairs();
    return pairs_;
}

template <class Real>
void UniformGrid<Real>::find_in_level(const GridLevel<Real>& level, const Executor& executor) {
    if (!executor.is_parallel(level.places)) {
        append_pairs(*kernels_, level, 0, level.places, pairs_);
        return;
    }
    const std::size_t chunks = (level.places + kPlacesPerChunk - 1) / kPlacesPerChunk;
    if (chunk_pairs_.size() < chunks) chunk_pairs_.resize(chunks);
    executor.for_each_chunk(level.places, kPlacesPerChunk,
                            [&](std::size_t c, std::size_t first, std::size_t last) {
                                chunk_pairs_[c].count = 0;
                                append_pairs(*kernels_, level, first, last, chunk_pairs_[c]);
                            });
    std::size_t count = pairs_.count;
    for (std::size_t c = 0; c < chunks; ++c) count += chunk_pairs_[c].count;
    make_room(pairs_, count);
    executor.for_each_task(chunks, kNanosecondsToCopy * static_cast<double>(count), [&](std::size_t chunk) {
        std::size_t begin = pairs_.count;
        for (std::size_t c = 0; c < chunk; ++c) begin += chunk_pairs_[c].count;
        const CandidatePairs& found = chunk_pairs_[chunk];
        std::copy_n(found.a.data(), found.count, pairs_.a.data() + begin);
        std::copy_n(found.b.data(), found.count, pairs_.b.data() + begin);
    });
    pairs_.count = count;
}

/// Pairs of a coarse body, a, and a fine one, b. Each body of one level looks around itself in the other: of
/// the two ways the one that is expected to scan fewer rows of cells.
template <class Real>
void UniformGrid<Real>::find_across(const GridLevel<Real>& coarse, const GridLevel<Real>& fine) {
    const double ratio = static_cast<double>(coarse.largest_reach) / static_cast<double>(fine.largest_reach);
    const double rows_of_fine_cells = (ratio + 3) * static_cast<double>(coarse.places);
    const double rows_of_coarse_cells = 3 * static_cast<double>(fine.places);
    const bool from_coarse = !fine.numbering.wraps && rows_of_fine_cells < rows_of_coarse_cells;
    const GridLevel<Real>& probes = from_coarse ? coarse : fine;
    const GridLevel<Real>& level = from_coarse ? fine : coarse;
    look_into(level, probes, from_coarse ? pairs_.a : pairs_.b, from_coarse ? pairs_.b : pairs_.a,
              [](std::size_t) { return false; });
}

/// Most bodies are often far from all that stands: those are not looked up.
template <class Real>
void UniformGrid<Real>::look_at_standing(const GridLevel<Real>& level, const GridLevel<Real>& probes) {
    constexpr double kCells = 2;  // around the occupied ones: a reach, and rounding
    const CellNumbering& n = level.numbering;
    const double side = 1 / n.inverse_size;
    // The farthest cells reach to infinity.
    const auto low_end = [&](double cell) {
        return cell > -kFarthestCell ? side * (cell - kCells) : -HUGE_VAL;
    };
    const auto high_end = [&](double cell) {
        return cell < kFarthestCell ? side * (cell + 1 + kCells) : HUGE_VAL;
    };
    const double low_x = low_end(n.low_u), high_x = high_end(n.high_u), low_y = low_end(n.low_v),
                 high_y = high_end(n.high_v);
    const SortedBodies<Real>& bodies = probes.bodies;
    look_into(level, probes, pairs_.a, pairs_.b, [&](std::size_t place) {
        const double x = bodies.x[place], y = bodies.y[place], reach = bodies.reach[place];
        return x + reach < low_x || x - reach > high_x || y + reach < low_y || y - reach > high_y;
    });
}

/// Each body of one level, the probe, looks around itself in another one.
/// @param probe_rows, found_rows  of pairs_, which takes what is near
/// @param is_far  is_far(place), whether a probe is left out
template <class Real>
template <class IsFar>
void UniformGrid<Real>::look_into(const GridLevel<Real>& level, const GridLevel<Real>& probes,
                                  Column<std::int32_t>& probe_rows, Column<std::int32_t>& found_rows,
                                  const IsFar& is_far) {
    const SortedBodies<Real>& bodies = probes.bodies;
    for (std::size_t place = 0; place < probes.places; ++place) {
        if (is_far(place)) continue;
        const auto find = [&] {
            return kernels_->find_near(level,
                                       {bodies.x[place], bodies.y[place], bodies.reach[place],
                                        found_rows.data() + pairs_.count, found_rows.size() - pairs_.count});
        };
        std::size_t found = find();
        while (found == kNoRoom) {
            make_room(pairs_, 2 * pairs_.a.size() + level.places);
            found = find();
        }
        std::fill_n(probe_rows.data() + pairs_.count, found, bodies.row[place]);
        pairs_.count += found;
    }
}

template <class Real>
void UniformGrid<Real>::drop_immovable_pairs() {
    std::size_t kept = 0;
    for (std::size_t pair = 0; pair < pairs_.count; ++pair) {
        const std::int32_t a = pairs_.a[pair], b = pairs_.b[pair];
        pairs_.a[kept] = a;
        pairs_.b[kept] = b;
        kept += (flags_[a] & flags_[b] & kImmovable) == 0 ? 1 : 0;
    }
    pairs_.count = kept;
}

template <class Real>
void UniformGrid<Real>::pad_pairs() {
    make_room(pairs_, padded(pairs_.count));
    const auto dummy = static_cast<std::int32_t>(count_);
    std::fill(pairs_.a.data() + pairs_.count, pairs_.a.data() + padded(pairs_.count), dummy);
    std::fill(pairs_.b.data() + pairs_.count, pairs_.b.data() + padded(pairs_.count), dummy);
}

template <class Real>
std::size_t UniformGrid<Real>::find_near(Real x, Real y, Real reach, Column<std::int32_t>& rows,
                                         Real more) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < level_count(); ++i) {
        const GridLevel<Real>& view = level(i);
        const Real farther = reach + more * view.largest_reach;
        for (;;) {
            const std::size_t found =
                kernels_->find_near(view, {x, y, farther, rows.data() + count, rows.size() - count});
            if (found != kNoRoom) {
                count += found;
                break;
            }
            rows.resize(2 * rows.size() + 8 * kRowPadding);
        }
    }
    return count;
}

template class UniformGrid<float>;
template class UniformGrid<double>;

}  // namespace carom

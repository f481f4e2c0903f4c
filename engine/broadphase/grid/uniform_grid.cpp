#include "broadphase/grid/uniform_grid.hpp"

#include <algorithm>

namespace carom {
namespace {

// Twice what a level of mixed sizes is made for; docs/decisions/0001-broadphase.md.
constexpr double kMostBodiesSharingACell = 2 * kMostBodiesInPackedCell;

bool any_flag(const std::uint8_t* flags, std::size_t count, std::uint8_t flag) {
    std::uint8_t all = 0;
    for (std::size_t row = 0; row < count; ++row) all = static_cast<std::uint8_t>(all | flags[row]);
    return (all & flag) != 0;
}

bool any_immovable_in_grid(const std::uint8_t* flags, std::size_t count) {
    bool any = false;
    for (std::size_t row = 0; row < count; ++row)
        any |= (flags[row] & (kImmovable | kNotInGrid)) == kImmovable;
    return any;
}

}  // namespace

template <class Real>
void UniformGrid<Real>::build(const GridInput<Real>& input, const KernelTable<Real>& kernels,
                              const Executor& executor) {
    kernels_ = &kernels;
    count_ = input.count;
    flags_ = input.flags;
    const std::size_t moving = count_ - input.standing;
    has_immovable_ = flags_ && any_immovable_in_grid(flags_, moving);  // no standing body looks for others
    keep_positions(input, executor);
    order_.resize(count_);

    GridInput<Real> of_moving = input;
    of_moving.count = moving;
    build_moving(of_moving, executor);
    list_order(moving_, rows_of(input, 0, moving));
    if (input.is_standing_known) return;
    standing_.count = 0;
    if (input.standing == 0) return;
    build_levels(standing_, rows_of(input, moving, count_), executor);
    list_order(standing_, rows_of(input, moving, count_));
}

template <class Real>
void UniformGrid<Real>::build_moving(const GridInput<Real>& input, const Executor& executor) {
    moving_.count = 0;
    if (input.count == 0) return;
    FindBounds<Real> bounds{input.x, input.y, input.reach, input.count, {}, {}, {}, {}, {}, {}};
    kernels_->find_bounds(bounds);
    const bool one_size =
        static_cast<double>(bounds.min_reach) * kLargestRatioInLevel >= static_cast<double>(bounds.max_reach);
    if (one_size && !(flags_ && any_flag(flags_, input.count, kNotInGrid)))
        build_one_level(input, bounds, executor);
    else
        build_levels(moving_, rows_of(input, 0, input.count), executor);
}

template <class Real>
void UniformGrid<Real>::keep_positions(const GridInput<Real>& input, const Executor& executor) {
    const std::size_t rows = input.is_standing_known ? count_ - input.standing : count_;
    built_x_.resize(count_);
    built_y_.resize(count_);
    executor.for_each_chunk(rows, kRowsPerChunk, [&](std::size_t, std::size_t first, std::size_t last) {
        std::copy(input.x + first, input.x + last, built_x_.data() + first);
        std::copy(input.y + first, input.y + last, built_y_.data() + first);
    });
}

template <class Real>
void UniformGrid<Real>::build_one_level(const GridInput<Real>& input, const FindBounds<Real>& bounds,
                                        const Executor& executor) {
    moving_.count = 1;
    if (moving_.levels.empty()) moving_.levels.resize(1);
    moving_.levels[0].sort({input.x, input.y, input.reach, nullptr, input.count, bounds, bounds.max_reach},
                           *kernels_, executor);
}

/// Grouping sizes by area is tried first; bodies that overlap or crowd in a corner can make its cells too
/// full.
template <class Real>
void UniformGrid<Real>::build_levels(Levels& levels, const Rows& rows, const Executor& executor) {
    levels.classes.count(rows.reach, rows.flags, rows.count);
    levels.classes.group(Grouping::by_area);
    sort_levels(levels, rows, executor);
    for (std::size_t level = 0; level < levels.count; ++level)
        if (levels.classes.is_mixed(level) &&
            levels.levels[level].bodies_sharing_a_cell() > kMostBodiesSharingACell) {
            levels.classes.group(Grouping::by_ratio);
            sort_levels(levels, rows, executor);
            return;
        }
}

template <class Real>
void UniformGrid<Real>::sort_levels(Levels& levels, const Rows& rows, const Executor& executor) {
    levels.count = levels.classes.level_count();
    if (levels.levels.size() < levels.count) levels.levels.resize(levels.count);
    split_by_level(levels, rows);
    for (std::size_t level = 0; level < levels.count; ++level) {
        const std::size_t first = split_.first[level], bodies = levels.classes.bodies(level);
        FindBounds<Real> bounds{split_.x.data() + first,
                                split_.y.data() + first,
                                split_.reach.data() + first,
                                bodies,
                                {},
                                {},
                                {},
                                {},
                                {},
                                {}};
        kernels_->find_bounds(bounds);
        levels.levels[level].sort({bounds.x, bounds.y, bounds.reach, split_.row.data() + first, bodies,
                                   bounds, levels.classes.largest_reach(level)},
                                  *kernels_, executor);
    }
}

template <class Real>
void UniformGrid<Real>::split_by_level(const Levels& levels, const Rows& rows) {
    split_.first.resize(levels.count);
    std::size_t places = 0;
    for (std::size_t level = 0; level < levels.count; ++level) {
        split_.first[level] = places;
        places += padded(levels.classes.bodies(level));
    }
    for (Column<Real>* column : {&split_.x, &split_.y, &split_.reach}) column->resize_for_overwrite(places);
    split_.row.resize_for_overwrite(places);

    std::vector<std::size_t>& next = split_.next;
    next.assign(split_.first.begin(), split_.first.end());
    for (std::size_t i = 0; i < rows.count; ++i) {
        if (rows.flags && (rows.flags[i] & kNotInGrid)) continue;
        const std::size_t place = next[levels.classes.level_of(rows.reach[i])]++;
        split_.x[place] = rows.x[i];
        split_.y[place] = rows.y[i];
        split_.reach[place] = rows.reach[i];
        split_.row[place] = static_cast<std::int32_t>(rows.first + i);
    }
}

template <class Real>
void UniformGrid<Real>::list_order(const Levels& levels, const Rows& rows) {
    std::int32_t* next = order_.data() + rows.first;
    const std::int32_t* const end = next + rows.count;
    for (std::size_t level = 0; level < levels.count; ++level) {
        const std::span<const std::int32_t> sorted = levels.levels[level].rows();
        next = std::copy(sorted.begin(), sorted.end(), next);
    }
    if (next == end) return;
    for (std::size_t i = 0; i < rows.count; ++i)
        if (rows.flags[i] & kNotInGrid) *next++ = static_cast<std::int32_t>(rows.first + i);
}

template <class Real>
typename UniformGrid<Real>::Block UniformGrid<Real>::block_of(double x, double y,
                                                              double cells_a_side) const noexcept {
    if (moving_.count == 0) return {0, 0};
    const CellNumbering& n = moving_.finest().numbering;
    const auto along = [&](double position, double low, double high) {
        const double cell = std::clamp(position * n.inverse_size, low, high) - low;
        return static_cast<std::size_t>(cell / cells_a_side);
    };
    return {along(x, n.low_u, n.high_u), along(y, n.low_v, n.high_v)};
}

template <class Real>
typename UniformGrid<Real>::Block UniformGrid<Real>::block_counts(double cells_a_side) const noexcept {
    if (moving_.count == 0) return {0, 0};
    const CellNumbering& n = moving_.finest().numbering;
    if (n.wraps) return {0, 0};
    const auto along = [&](double low, double high) {
        return static_cast<std::size_t>((high - low) / cells_a_side) + 1;
    };
    return {along(n.low_u, n.high_u), along(n.low_v, n.high_v)};
}

template <class Real>
std::size_t UniformGrid<Real>::bytes() const noexcept {
    std::size_t sum = built_x_.bytes() + built_y_.bytes() + split_.x.bytes() + split_.y.bytes() +
                      split_.reach.bytes() + split_.row.bytes() + order_.bytes() + near_.bytes();
    for (const Levels* levels : {&moving_, &standing_}) {
        sum += levels->classes.bytes();
        for (const SortedLevel<Real>& level : levels->levels) sum += level.bytes();
    }
    sum += pairs_.a.bytes() + pairs_.b.bytes();
    for (const CandidatePairs& pairs : chunk_pairs_) sum += pairs.a.bytes() + pairs.b.bytes();
    return sum;
}

template class UniformGrid<float>;
template class UniformGrid<double>;

}  // namespace carom

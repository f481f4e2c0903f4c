#include "broadphase/uniform_grid.hpp"

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
    has_immovable_ = flags_ && any_immovable_in_grid(flags_, count_);
    keep_positions(input, executor);

    level_count_ = 0;
    if (count_ > 0) {
        FindBounds<Real> bounds{input.x, input.y, input.reach, count_, {}, {}, {}, {}, {}, {}};
        kernels.find_bounds(bounds);
        const bool one_size = static_cast<double>(bounds.min_reach) * kLargestRatioInLevel >=
                              static_cast<double>(bounds.max_reach);
        if (one_size && !(flags_ && any_flag(flags_, count_, kNotInGrid)))
            build_one_level(input, bounds, executor);
        else
            build_levels(input, executor);
    }
    list_order(input);
}

template <class Real>
void UniformGrid<Real>::keep_positions(const GridInput<Real>& input, const Executor& executor) {
    built_x_.resize_for_overwrite(count_);
    built_y_.resize_for_overwrite(count_);
    executor.for_each_chunk(count_, kRowsPerChunk, [&](std::size_t, std::size_t first, std::size_t last) {
        std::copy(input.x + first, input.x + last, built_x_.data() + first);
        std::copy(input.y + first, input.y + last, built_y_.data() + first);
    });
}

template <class Real>
void UniformGrid<Real>::build_one_level(const GridInput<Real>& input, const FindBounds<Real>& bounds,
                                        const Executor& executor) {
    level_count_ = 1;
    if (levels_.empty()) levels_.resize(1);
    levels_[0].sort({input.x, input.y, input.reach, nullptr, count_, bounds, bounds.max_reach}, *kernels_,
                    executor);
}

/// Grouping sizes by area is tried first; bodies that overlap or crowd in a corner can make its cells too
/// full.
template <class Real>
void UniformGrid<Real>::build_levels(const GridInput<Real>& input, const Executor& executor) {
    classes_.count(input.reach, flags_, count_);
    classes_.group(Grouping::by_area);
    sort_levels(input, executor);
    for (std::size_t level = 0; level < level_count_; ++level)
        if (classes_.is_mixed(level) && levels_[level].bodies_sharing_a_cell() > kMostBodiesSharingACell) {
            classes_.group(Grouping::by_ratio);
            sort_levels(input, executor);
            return;
        }
}

template <class Real>
void UniformGrid<Real>::sort_levels(const GridInput<Real>& input, const Executor& executor) {
    level_count_ = classes_.level_count();
    if (levels_.size() < level_count_) levels_.resize(level_count_);
    split_by_level(input);
    for (std::size_t level = 0; level < level_count_; ++level) {
        const std::size_t first = split_.first[level], bodies = classes_.bodies(level);
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
        levels_[level].sort({bounds.x, bounds.y, bounds.reach, split_.row.data() + first, bodies, bounds,
                             classes_.largest_reach(level)},
                            *kernels_, executor);
    }
}

template <class Real>
void UniformGrid<Real>::split_by_level(const GridInput<Real>& input) {
    split_.first.resize(level_count_);
    std::size_t places = 0;
    for (std::size_t level = 0; level < level_count_; ++level) {
        split_.first[level] = places;
        places += padded(classes_.bodies(level));
    }
    for (Column<Real>* column : {&split_.x, &split_.y, &split_.reach}) column->resize_for_overwrite(places);
    split_.row.resize_for_overwrite(places);

    std::vector<std::size_t>& next = split_.next;
    next.assign(split_.first.begin(), split_.first.end());
    for (std::size_t row = 0; row < count_; ++row) {
        if (flags_ && (flags_[row] & kNotInGrid)) continue;
        const std::size_t place = next[classes_.level_of(input.reach[row])]++;
        split_.x[place] = input.x[row];
        split_.y[place] = input.y[row];
        split_.reach[place] = input.reach[row];
        split_.row[place] = static_cast<std::int32_t>(row);
    }
}

template <class Real>
void UniformGrid<Real>::list_order(const GridInput<Real>& input) {
    order_.resize_for_overwrite(count_);
    std::int32_t* next = order_.data();
    for (std::size_t level = 0; level < level_count_; ++level) {
        const std::span<const std::int32_t> rows = levels_[level].rows();
        next = std::copy(rows.begin(), rows.end(), next);
    }
    if (next == order_.end()) return;
    for (std::size_t row = 0; row < count_; ++row)
        if (input.flags[row] & kNotInGrid) *next++ = static_cast<std::int32_t>(row);
}

template <class Real>
typename UniformGrid<Real>::Block UniformGrid<Real>::block_of(double x, double y,
                                                              double cells_a_side) const noexcept {
    if (level_count_ == 0) return {0, 0};
    const CellNumbering& n = levels_[level_count_ - 1].view().numbering;
    const auto along = [&](double position, double low, double high) {
        const double cell = std::clamp(position * n.inverse_size, low, high) - low;
        return static_cast<std::size_t>(cell / cells_a_side);
    };
    return {along(x, n.low_u, n.high_u), along(y, n.low_v, n.high_v)};
}

template <class Real>
typename UniformGrid<Real>::Block UniformGrid<Real>::block_counts(double cells_a_side) const noexcept {
    if (level_count_ == 0) return {0, 0};
    const CellNumbering& n = levels_[level_count_ - 1].view().numbering;
    if (n.wraps) return {0, 0};
    const auto along = [&](double low, double high) {
        return static_cast<std::size_t>((high - low) / cells_a_side) + 1;
    };
    return {along(n.low_u, n.high_u), along(n.low_v, n.high_v)};
}

template <class Real>
std::size_t UniformGrid<Real>::bytes() const noexcept {
    std::size_t sum = classes_.bytes() + built_x_.bytes() + built_y_.bytes() + split_.x.bytes() +
                      split_.y.bytes() + split_.reach.bytes() + split_.row.bytes() + order_.bytes() +
                      near_.bytes();
    for (const SortedLevel<Real>& level : levels_) sum += level.bytes();
    sum += pairs_.a.bytes() + pairs_.b.bytes();
    for (const CandidatePairs& pairs : chunk_pairs_) sum += pairs.a.bytes() + pairs.b.bytes();
    return sum;
}

template class UniformGrid<float>;
template class UniformGrid<double>;

}  // namespace carom

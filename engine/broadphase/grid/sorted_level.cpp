#include "broadphase/grid/sorted_level.hpp"

#include "broadphase/grid/cell_numbering.hpp"

#include <algorithm>
#include <limits>

namespace carom {
namespace {

constexpr double kCellMargin = 1 + 1e-5;  // cells are that much larger than twice the largest reach: rounding
constexpr double kSmallestCell = 1e-30;   // m, where no body has any reach

}  // namespace

template <class Real>
void SortedLevel<Real>::sort(const LevelInput<Real>& input, const KernelTable<Real>& kernels,
                             const Executor& executor) {
    const double size = std::max(2 * static_cast<double>(input.largest_reach) * kCellMargin, kSmallestCell);
    view_.numbering = number_cells(input.bounds, input.x, input.y, input.count, size);
    view_.width = static_cast<std::int32_t>(view_.numbering.width);
    view_.cells = static_cast<std::int32_t>(view_.numbering.cells);
    view_.largest_reach = input.largest_reach;
    view_.places = input.count;
    find_cells(input, kernels, executor);
    count_cells(input.count);
    place_bodies(input);
    bind_view();
}

template <class Real>
void SortedLevel<Real>::find_cells(const LevelInput<Real>& input, const KernelTable<Real>& kernels,
                                   const Executor& executor) {
    unsorted_cell_.resize_for_overwrite(input.count);
    executor.for_each_chunk(input.count, kRowsPerChunk,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                kernels.find_cells({input.x + first, input.y + first, last - first,
                                                    view_.numbering, unsorted_cell_.data() + first});
                            });
}

/// cell_begin_[c + 1] becomes the number of bodies in cells before c: place_bodies counts it up to the begin
/// of cell c + 1, so that no second array is needed.
template <class Real>
void SortedLevel<Real>::count_cells(std::size_t count) {
    const auto cells = static_cast<std::size_t>(view_.cells);
    const std::size_t size = cell_begin_size(cells, static_cast<std::size_t>(view_.width));
    cell_begin_.resize_for_overwrite(size);
    std::int32_t* begin = cell_begin_.data();
    std::fill(begin, begin + cells + 2, 0);
    for (std::size_t i = 0; i < count; ++i) ++begin[unsorted_cell_[i] + 2];
    std::int32_t sum = 0;
    for (std::size_t c = 0; c < cells + 2; ++c) begin[c] = sum += begin[c];
    std::fill(begin + cells + 1, begin + size, static_cast<std::int32_t>(count));
}

template <class Real>
void SortedLevel<Real>::place_bodies(const LevelInput<Real>& input) {
    const std::size_t count = input.count;
    for (Column<Real>* column : {&x_, &y_, &reach_}) column->resize_for_overwrite(count + kPlacesBeyond);
    for (Column<std::int32_t>* column : {&row_, &cell_}) column->resize_for_overwrite(count + kPlacesBeyond);
    std::int32_t* next = cell_begin_.data() + 1;
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t cell = unsorted_cell_[i];
        const auto place = static_cast<std::size_t>(next[cell]++);
        x_[place] = input.x[i];
        y_[place] = input.y[i];
        reach_[place] = input.reach[i];
        row_[place] = input.row ? input.row[i] : static_cast<std::int32_t>(i);
        cell_[place] = cell;
    }
    std::fill_n(x_.data() + count, kPlacesBeyond, std::numeric_limits<Real>::infinity());
    std::fill_n(y_.data() + count, kPlacesBeyond, Real{0});
    std::fill_n(reach_.data() + count, kPlacesBeyond, Real{0});
    // A batch that is read at the end has rows of its own line alone.
    std::fill_n(row_.data() + count, kPlacesBeyond, row_[count - 1]);
    std::fill_n(cell_.data() + count, kPlacesBeyond, 0);  // of saved states every byte is known
}

template <class Real>
double SortedLevel<Real>::bodies_sharing_a_cell() const noexcept {
    std::int64_t sum = 0;
    for (std::size_t cell = 0; cell < static_cast<std::size_t>(view_.cells); ++cell) {
        const std::int64_t bodies = cell_begin_[cell + 1] - cell_begin_[cell];
        sum += bodies * bodies;
    }
    return static_cast<double>(sum) / static_cast<double>(view_.places);
}

template <class Real>
std::size_t SortedLevel<Real>::bytes() const noexcept {
    return unsorted_cell_.bytes() + cell_begin_.bytes() + x_.bytes() + y_.bytes() + reach_.bytes() +
           row_.bytes() + cell_.bytes();
}

template class SortedLevel<float>;
template class SortedLevel<double>;

}  // namespace carom

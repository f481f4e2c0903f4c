#pragma once

#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "state/columns/column.hpp"

#include <span>
#include <type_traits>

namespace carom {

/// Bodies of one size class, before they are sorted. Columns are padded and 64-byte aligned.
template <class Real>
struct LevelInput {
    const Real* x;            // m, [count]
    const Real* y;            // m
    const Real* reach;        // m
    const std::int32_t* row;  // in the columns of the world; null: i
    std::size_t count;        // > 0
    FindBounds<Real> bounds;  // of x and y at least
    Real largest_reach;       // m
};

/// One level of the uniform grid: its bodies counted into cells and sorted by cell, in the order of the input
/// within a cell.
template <class Real>
class SortedLevel {
  public:
    SortedLevel() = default;
    SortedLevel(SortedLevel&&) noexcept = default;  // not copied: the view points into the columns
    SortedLevel& operator=(SortedLevel&&) noexcept = default;

    void sort(const LevelInput<Real>& input, const KernelTable<Real>& kernels, const Executor& executor);

    /// Valid until the next sort.
    const GridLevel<Real>& view() const noexcept { return view_; }
    std::span<const std::int32_t> rows() const noexcept { return {row_.data(), view_.places}; }
    /// Mean over the bodies of how many are in their cell. Cost: O(cells).
    double bodies_sharing_a_cell() const noexcept;
    std::size_t bytes() const noexcept;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.view_.places, self.view_.numbering, self.view_.width, self.view_.cells);
        archive(self.view_.largest_reach, self.cell_begin_, self.x_, self.y_, self.reach_, self.row_,
                self.cell_);
        if constexpr (!std::is_const_v<Self>) self.bind_view();
    }

  private:
    void find_cells(const LevelInput<Real>& input, const KernelTable<Real>& kernels,
                    const Executor& executor);
    void count_cells(std::size_t count);
    void place_bodies(const LevelInput<Real>& input);
    void bind_view() {
        view_.bodies = {x_.data(), y_.data(), reach_.data(), row_.data(), cell_.data(), cell_begin_.data()};
    }

    GridLevel<Real> view_{};
    Column<std::int32_t> unsorted_cell_;
    Column<std::int32_t> cell_begin_;
    Column<Real> x_, y_, reach_;
    Column<std::int32_t> row_, cell_;
};

}  // namespace carom

#pragma once

#include <cstdint>
#include <vector>

#include "broadphase/uniform_grid.hpp"
#include "effects/flight.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "state/bodies.hpp"

namespace carom {

/// The candidate pairs of a world, with margins, reused from step to step.
///
/// Each body has a margin of its own: a pair is a candidate if its bodies, grown by their margins, overlap.
/// As long as no body has left its margin, no pair that is not a candidate can touch. Most bodies share one
/// margin, a few steps of the fastest; bodies that cross more than that in a single step get what they need,
/// and the grid's size classes keep them from slowing down the rest.
template <class Real>
class Candidates {
  public:
    /// Makes the columns fit; a change of their length makes the pairs void.
    void prepare(std::size_t count);

    /// Forgets the pairs: rows, radii or positions were changed from outside.
    void invalidate() { is_valid_ = false; }

    /// Finds the pairs anew if they are void or if a body is about to leave its margin. `is_displaced`:
    /// whether the flight that begins now takes some body out of its margin.
    void update(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity, bool is_displaced,
                const KernelTable<Real>& kernels, const Executor& executor);

    /// Rows of bodies that can touch body `row`, whose flight ends at `end`, before the pairs are found anew.
    /// @return how many rows are in `out`, `row` itself among them.
    std::size_t find_near(std::int32_t row, Vec2 end, double radius, Column<std::int32_t>& out) const;

    std::size_t pair_count() const { return grid_.candidates().count; }
    const std::int32_t* pair_a() const { return grid_.candidates().a.data(); }  ///< [padded(pair_count)]
    const std::int32_t* pair_b() const { return grid_.candidates().b.data(); }

    bool is_valid() const { return is_valid_; }
    const Column<Real>& built_x() const {
        return grid_.built_x();
    }  ///< m, where the pairs were found, if valid
    const Column<Real>& built_y() const { return grid_.built_y(); }
    const Column<Real>& reach() const { return reach_; }  ///< m, radius plus margin
    double largest_radius() const { return largest_radius_; }
    double smallest_radius() const { return smallest_radius_; }

    /// Whether rows have drifted so far from the order of the cells that sorting them pays.
    bool wants_sorted_rows() const { return is_valid_ && wants_sorted_rows_; }
    /// Row of each place in the order of the cells.
    const std::int32_t* order() const { return grid_.order().data(); }

    std::int64_t rebuild_count() const { return rebuild_count_; }
    std::size_t bytes() const;

  private:
    void choose_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity);

    UniformGrid<Real> grid_;
    Column<Real> reach_;
    double largest_radius_ = 0, smallest_radius_ = 0;
    bool is_valid_ = false;
    bool wants_sorted_rows_ = false;
    std::int64_t rebuild_count_ = 0;
    std::int64_t rebuilds_since_sorted_ = 0;
};

extern template class Candidates<float>;
extern template class Candidates<double>;

}  // namespace carom

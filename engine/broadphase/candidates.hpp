#pragma once

#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/grid/uniform_grid.hpp"
#include "broadphase/moving_places.hpp"
#include "broadphase/row_names.hpp"
#include "broadphase/slim_bodies.hpp"
#include "effects/flight.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "state/bodies.hpp"
#include "state/radii.hpp"

namespace carom {

/// How bodies get their margins, and what becomes of a body that leaves its own.
enum class MarginRule : std::uint8_t {
    /// One for most, by the fastest body. Strays are left to the solver, which looks around them.
    common,
    /// Each body's own, by its own speed. Strays get new margins, and the pairs that come with them are
    /// added.
    own,
};

/// The candidate pairs of a world, with margins, reused from step to step.
///
/// Each body has a margin of its own: a pair is a candidate if its bodies, grown by their margins, overlap.
/// As long as no body has left its margin, no pair that is not a candidate can touch. Most bodies share one
/// margin; those that cross more than that in a single step get what they need, and the grid's size classes
/// keep them from slowing down the rest. In a gas there is always some body that was just kicked out of its
/// margin: such strays, while they are few, are looked up one by one, and the pairs of all the others stay in
/// use.
template <class Real>
class Candidates {
  public:
    explicit Candidates(MarginRule rule = MarginRule::common) : rule_(rule) {}

    /// Makes the columns fit; a change of their length makes the pairs void.
    void prepare(std::size_t count);

    /// Forgets the pairs: rows, radii or positions were changed from outside.
    void invalidate() { is_valid_ = radii_are_known_ = is_standing_known_ = false; }
    /// Forgets the pairs alone.
    void invalidate_pairs() { is_valid_ = false; }

    /// Rule `own`: follows rows that changed since the last step without making the pairs void. Bodies that
    /// came or were put elsewhere are looked for by `update`, those that are gone are in no pair any more.
    /// pair_a and pair_b stay those of the rows before.
    /// @param now  present row of each former one, or negative
    /// @param is_elsewhere  a present row, whether its body was put elsewhere
    /// Cost: O(bodies), about 1 ns each, and O(bodies) in `update` for each that came or was put elsewhere.
    void follow_rows(const Bodies<Real>& bodies, std::span<const std::int32_t> now,
                     std::span<const std::uint8_t> is_elsewhere);
    /// Whether so many rows may change without the pairs being void.
    /// @param count  bodies, but for standing ones
    bool may_follow(std::size_t changed, std::size_t count) const {
        return rule_ == MarginRule::own && is_valid_ && changed * count <= kMostComparisons &&
               may_renew(changed, count) && names_.loose_count() + changed <= kMostLoose;
    }

    /// Finds the pairs anew if they are void or if too many bodies leave their margins on the flights that
    /// begin now.
    /// @param displaced  rows whose flight leaves the margin
    /// @param fastest  m/s, of all bodies
    /// @param shapes  rule `own`: of bodies that are no discs; null: pairs are those of the discs around them
    void update(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                std::span<const std::int32_t> displaced, double fastest, const KernelTable<Real>& kernels,
                const Executor& executor, const ShapeStore<Real>* shapes = nullptr);

    /// Bodies that leave their margins in this substep: what they can hit is not among the pairs.
    std::span<const std::int32_t> strays() const { return strays_; }
    /// How far the strays leave their margins [m].
    double overshoot() const { return overshoot_; }
    /// How far body `row` leaves its margin if its flight ends at `end` [m]; 0 if it does not.
    double overshoot_of(std::int32_t row, double radius, Vec2 end) const;

    /// Rows of all bodies that can come within `reach` of a place while no flight leaves its margin; one that
    /// does by some overshoot is found if `reach` is larger by that much.
    /// @param more  share by which bodies are to reach farther, of the largest of their size
    /// @return how many rows are in `out`.
    std::size_t find_near(Vec2 place, double reach, Column<std::int32_t>& out, double more = 0) const {
        return grid_.find_near(static_cast<Real>(place.x), static_cast<Real>(place.y),
                               static_cast<Real>(reach * kRoundingUp), out,
                               static_cast<Real>(more * kRoundingUp));
    }

    /// Rule `own`: how far a body at `place` is out of its margin at the end of the step [m]; 0 if it is not.
    double outside_of_margin(std::size_t row, double radius, Vec2 at) const {
        const Vec2 way = at - places_.place(row);
        return std::fmax(0, std::sqrt(length_squared(way)) - (static_cast<double>(reach_[row]) - radius));
    }
    /// Rule `own`: rows of all bodies within their margins that can touch, at the end of the step, one of
    /// `radius` that was in the place of body `row` and is `at` by then.
    /// @return how many rows are in `out`.
    std::size_t find_around(std::size_t row, double radius, Vec2 at, Column<std::int32_t>& out) const;

    /// Rule `own`: rows of all bodies within their margins that can come, up to the end of the step, within
    /// `reach` of a place. Bodies that were thrown out of their margins in this step are not among them.
    /// @return how many rows are in `out`.
    std::size_t find_up_to_end(Vec2 place, double reach, Column<std::int32_t>& out) const {
        return find_rows_near(place, reach + farthest_ + largest_drift(), out);
    }

    /// Pairs that have been added in this step since `update`, rule `own`: not among pair_a and pair_b.
    struct Pair {
        std::int32_t a, b;
        friend auto operator<=>(const Pair&, const Pair&) = default;
    };
    std::span<const Pair> new_pairs() const { return new_pairs_; }
    /// The reach a row had when the pairs were found anew [m]; its place then is the grid's.
    Real first_reach(std::size_t row) const {
        return rule_ == MarginRule::own ? first_reach_[row] : reach_[row];
    }
    /// How far a body's place and reach go beyond those it had first, but for what it drifted [m].
    double farther_than_first(std::size_t row) const {
        if (is_loose(row)) return HUGE_VAL;
        const Vec2 from = places_.place(row) - places_.drift_of(row);
        const double x = from.x - first_x(row), y = from.y - first_y(row);
        return std::sqrt(x * x + y * y) + static_cast<double>(reach_[row] - first_reach_[row]);
    }
    /// Where a row was when the pairs were found anew [m]; not of one that came since.
    Real first_x(std::size_t row) const { return grid_.built_x()[names_.name_of(row)]; }
    Real first_y(std::size_t row) const { return grid_.built_y()[names_.name_of(row)]; }
    /// Whether a body came, or was put elsewhere, since the pairs were found anew.
    bool is_loose(std::size_t row) const { return names_.is_loose(row); }
    /// Rule `own`: rows of all bodies whose margins are within `reach` of a place, and some besides.
    /// @return how many rows are in `out`.
    std::size_t find_margins_near(Vec2 place, double reach, Column<std::int32_t>& out) const {
        return find_rows_near(place, reach + farthest_ + places_.largest_drift_so_far(), out);
    }

    /// How far places, built_x and built_y, may go with the mean flow of the bodies before the pairs are void
    /// [m]. Lists of what a body reaches besides other bodies, as walls and edges, have to look farther by
    /// that.
    double largest_drift() const { return places_.largest_drift(); }

    /// Whether a good part of the bodies fly so fast together that places may go farther than they else do.
    bool flies_together() const { return places_.flies_together(radii_.usual); }

    /// Rule `own`: moves the places with the mean flow. To be called first in every step of length dt [s].
    /// A body that has used up its margin by that has a reach of its radius; it is to be taken for a stray.
    /// Cost: O(bodies), about 1 ns each; nothing where bodies are at rest.
    void move_places(const Bodies<Real>& bodies, double dt, const Executor& executor);

    /// Rule `own`: pairs, of those the grid found, of bodies that are in reach of each other because one
    /// travels far in a step. Their number goes by speed, that of all other pairs by how densely bodies lie.
    /// 0 where pairs are void. Cost: O(pairs), about 3 ns each.
    std::size_t count_far_pairs(const Bodies<Real>& bodies) const;

    std::size_t pair_count() const { return grid_.candidates().count; }
    const std::int32_t* pair_a() const { return grid_.candidates().a.data(); }  ///< [padded(pair_count)]
    const std::int32_t* pair_b() const { return grid_.candidates().b.data(); }

    bool is_valid() const { return is_valid_; }
    /// m, what a body's margin is around, at the end of the step: where it got it, or where the bodies
    /// around it have gone since; if valid
    const Column<Real>& built_x() const { return rule_ == MarginRule::own ? places_.x() : grid_.built_x(); }
    const Column<Real>& built_y() const { return rule_ == MarginRule::own ? places_.y() : grid_.built_y(); }
    const Column<Real>& reach() const { return reach_; }  ///< m, radius plus margin
    const UniformGrid<Real>& grid() const { return grid_; }
    /// The radii of the discs [m], as they were when the pairs were found last.
    double largest_radius() const { return radii_.largest; }
    double smallest_radius() const { return radii_.smallest; }
    double usual_radius() const { return radii_.usual; }
    /// Null if they may have changed since.
    const Radii* known_radii() const { return radii_are_known_ ? &radii_ : nullptr; }

    /// Whether rows have drifted so far from the order of the cells that sorting them pays.
    /// @param moving  rows that may move
    bool wants_sorted_rows(std::size_t moving) const;
    /// To be called when rows were sorted.
    void note_sorted_rows();
    /// Row of each place in the order of the cells; rows that came since the pairs were found are the last.
    const std::int32_t* order() const {
        return names_.empty() ? grid_.order().data() : names_.sorted_rows().data();
    }
    /// To be called before `order` where rows have changed.
    void prepare_order(std::size_t count) { names_.sort(grid_.order(), count); }

    std::int64_t rebuild_count() const { return rebuild_count_; }
    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.grid_, self.strays_, self.overshoot_, self.reach_, self.first_reach_, self.places_);
        archive(self.new_pairs_, self.added_pairs_, self.renewed_count_, self.farthest_, self.radii_);
        archive(self.names_, self.is_valid_, self.radii_are_known_, self.rebuild_count_,
                self.rebuilds_until_sorted_);
        archive(self.is_standing_known_, self.largest_standing_reach_, self.slim_);
    }
    /// To be called after the state was read.
    void use(const KernelTable<Real>& kernels) { grid_.use(kernels); }

  private:
    static constexpr double kRoundingUp = 1 + 1e-6;  // factor on a reach: it and the place are rounded
    /// Rule `own`: pairs are found anew when one body in this many has got a new margin.
    static constexpr std::size_t kBodiesPerRenewal = 8;
    /// A body's own margin is at most this many of the largest radius, unless 1.25 steps of it are more.
    static constexpr double kLargestOwnMargin = 1;

    /// Bodies that come in a step are compared with all others, and later, while the pairs last, with all
    /// that leave their margins: at most so many comparisons and bodies.
    static constexpr std::size_t kMostComparisons = 2'000'000, kMostLoose = 2048;

    /// As find_near, of today's rows, with all that the grid does not know.
    std::size_t find_rows_near(Vec2 place, double reach, Column<std::int32_t>& out, double more = 0) const {
        return names_.to_rows(out, find_near(place, reach, out, more));
    }

    /// Rows whose margins are found with the pairs: all, unless those of standing bodies are known.
    std::size_t rows_to_find(const Bodies<Real>& bodies) const {
        return is_standing_known_ ? bodies.moving() : bodies.count;
    }

    bool may_renew(std::size_t strays, std::size_t count) const {
        return (renewed_count_ + strays) * kBodiesPerRenewal <= count;
    }

    void choose_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity, double fastest);
    Real own_reach(const Bodies<Real>& bodies, std::size_t row, const FlightClock& end, double fall) const;
    void choose_own_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                            const ShapeStore<Real>* shapes, const Executor& executor);
    bool follow_flow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity,
                     const Executor& executor);
    void renew_margins(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity);
    void add_pairs_of(const Bodies<Real>& bodies, std::int32_t row);
    void set_rectangle(const Bodies<Real>& bodies, std::size_t row, double dt) {
        const auto reach = static_cast<double>(reach_[row]);
        slim_.set(bodies, row, places_.place(row), reach - static_cast<double>(bodies.radius[row]), reach,
                  dt);
    }
    /// Share of their distance by which places may come nearer by their drifts.
    double most_spread() const { return slim_.empty() ? HUGE_VAL : slim_.spread(); }
    bool was_pair(std::size_t a, std::size_t b) const;
    bool is_pair(std::size_t a, std::size_t b) const;

    MarginRule rule_;
    UniformGrid<Real> grid_;
    std::vector<std::int32_t> strays_;
    double overshoot_ = 0;
    Column<Real> reach_;
    // These members are of rule `own`, and hold what has happened since the pairs were found anew.
    MovingPlaces<Real> places_;
    Column<Real> first_reach_;  // m
    std::vector<Pair> new_pairs_, added_pairs_, spare_pairs_;
    RowNames names_;
    std::size_t renewed_count_ = 0;
    /// m, most that a renewed margin reaches beyond the first one, drift aside
    double farthest_ = 0;
    SlimBodies<Real> slim_;  // rule `own`
    Column<std::int32_t> near_;
    Radii radii_;
    bool is_valid_ = false;
    bool radii_are_known_ = false;
    bool is_standing_known_ = false;     // the grid has the standing bodies, and they their margins
    double largest_standing_reach_ = 0;  // m
    std::int64_t rebuild_count_ = 0;
    std::int64_t rebuilds_until_sorted_ = 0;
};

extern template class Candidates<float>;
extern template class Candidates<double>;

}  // namespace carom

#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "broadphase/mean_flow.hpp"
#include "broadphase/row_names.hpp"
#include "effects/flight.hpp"
#include "parallel/executor.hpp"
#include "state/bodies.hpp"
#include "state/columns/chunked_list.hpp"

namespace carom {

/// Places of bodies' margins that move with the mean flow: a pile that heaves or turns carries its bodies out
/// of their margins together, and the same bodies stay near each other. So a body's place moves at the
/// velocity of the bodies around it, its margin is for what it does beside that, and pairs last longer.
///
/// Let two bodies be at places p and reach R each, and be no candidates: |p_j - p_i| >= R_i + R_j. If both
/// places follow a field that brings points nearer by less than a share c of their distance, the same holds
/// for the new places with (1 - c) R: the pairs stay complete while bodies stay within the margins that are
/// left of these. docs/decisions/0016-moving-places.md has the measurements.
template <class Real>
class MovingPlaces {
  public:
    /// Bodies that are near each other now were at most this many times as far apart when they drifted.
    static constexpr double kSteepnessThen = 1.5;

    struct Lengths {
        double radius, reach;  // m: the usual radius; what most reaches are within, 0 if there are no discs
    };
    /// Places are where bodies are, and drift from now on with the flow of now, if there is one. For pairs
    /// that are found anew.
    /// @param rows  the first so many get places, the others keep those that they have
    void begin(const Bodies<Real>& bodies, std::size_t rows, Lengths usual, const FlightClock& end,
               Vec2 gravity, const Executor& executor);
    /// Bears in mind a reach that was chosen since `begin` [m].
    void note_reach(double reach);

    /// Moves places with the flow for a step of length dt [s]; reaches shrink as it brings places nearer to
    /// each other, to the radius at least. Cost: O(bodies), about 1 ns each; nothing where bodies are at
    /// rest.
    /// @param most_spread  no unit, what spread() may become
    /// @return whether the pairs stay complete.
    bool move(const Bodies<Real>& bodies, double dt, double most_spread, Column<Real>& reach,
              const Executor& executor);

    /// All places jump to where their bodies are on the whole, and go on with the flow of now. After failures
    /// most occasions to do so are left out. Cost: O(bodies), about 15 ns each.
    /// @param most_spread, reach  as of `move`
    /// @param strays  gets the rows of bodies that are left outside of their margins
    /// @return whether the pairs stay complete but for those of the strays.
    bool follow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity, double most_spread,
                Column<Real>& reach, std::vector<std::int32_t>& strays, const Executor& executor);
    /// The last `follow` has saved finding the pairs anew.
    void note_success() { failed_follows_ = 0; }

    /// A body gets the place where it will be in dt [s] if it goes from `at` with the flow there.
    void put(std::size_t row, Vec2 at, double dt);
    /// Bears in mind the reach that it got [m].
    void note_renewed_reach(double reach) { largest_reach_ = std::fmax(largest_reach_, reach); }

    /// Places go with their bodies when rows change; loose ones are where their bodies are.
    void follow_rows(const RowNames& names, const Bodies<Real>& bodies);

    const Column<Real>& x() const { return x_; }  ///< m, at the end of the step
    const Column<Real>& y() const { return y_; }
    Vec2 place(std::size_t row) const { return {x_[row], y_[row]}; }
    /// Velocity of a place [m/s].
    Vec2 velocity(std::size_t row) const { return {flow_x_[row], flow_y_[row]}; }
    /// How far a place has gone with the flow since `begin` [m].
    Vec2 drift_of(std::size_t row) const {
        return {drift_x_[row] + since_flow_ * flow_x_[row], drift_y_[row] + since_flow_ * flow_y_[row]};
    }
    /// How far places may go with the flow, and how far they may have gone [m].
    double largest_drift() const { return largest_drift_; }
    double largest_drift_so_far() const { return largest_drift_ - drift_left_; }
    /// Share of their distance by which the drifts of two places near each other differ, at most.
    double spread() const { return kSteepnessThen * steepness_; }
    /// By how much velocities of places differ over their distance, at most [1/s].
    double gradient_of_velocity() const { return flows_ ? flow_.most().gradient_of_velocity : 0; }
    /// m, the largest that was noted since `begin`
    double largest_reach() const { return largest_reach_; }
    /// Whether a good part of the bodies fly so fast together that places may go farther than they else do.
    /// @param usual_radius  m
    bool flies_together(double usual_radius) const {
        return flows_ && largest_drift_ > kLargestDrift * usual_radius;
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.x_, self.y_, self.drift_x_, self.drift_y_, self.flow_x_, self.flow_y_, self.rate_);
        archive(self.steepness_, self.largest_drift_, self.drift_left_, self.largest_reach_);
        archive(self.flow_, self.since_flow_, self.may_flow_, self.flows_, self.flow_is_local_);
        archive(self.failed_follows_, self.follows_left_out_);
    }
    std::size_t bytes() const;

  private:
    static constexpr double kLargestDrift = 6;  // usual radii that a place may drift by, if few are faster

    void measure_flow(const Bodies<Real>& bodies, const FlightClock& end, Vec2 gravity, bool is_new);
    double drift_with_flow(const Bodies<Real>& bodies, double usual_radius, double dt) const;
    void set_velocity(std::size_t row, const MeanFlow::At& flow);
    MeanFlow::At flow_here(std::size_t row, Vec2 at) const;

    Column<Real> x_, y_;                   // m
    Column<Real> drift_x_, drift_y_;       // m, way of a place up to where it began to follow this flow
    Column<Real> flow_x_, flow_y_, rate_;  // m/s, velocity of a place; 1/s, share of reach it loses
    MeanFlow flow_;
    double since_flow_ = 0;  // s, time for which places have followed this flow
    double steepness_ = 0;   // no unit: difference of the drifts of two places over their distance, at most
    double largest_drift_ = 0;  // m, way that places may go with the flow
    double drift_left_ = 0;     // m, way that places may still drift before the pairs are void
    double largest_reach_ = 0;  // m, the largest that was noted since `begin`
    bool may_flow_ = false, flows_ = false, flow_is_local_ = true;
    // Attempts to follow the flow that failed in a row, and occasions left out since the last attempt.
    int failed_follows_ = 0, follows_left_out_ = 0;
    ChunkedList stray_rows_;
};

extern template class MovingPlaces<float>;
extern template class MovingPlaces<double>;

}  // namespace carom

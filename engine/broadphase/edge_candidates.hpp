#pragma once

#include <compare>
#include <cstdint>
#include <span>
#include <type_traits>
#include <vector>

#include "broadphase/candidates.hpp"
#include "math/rotation.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Place and turn of a body at the start and at the end of a step.
struct EdgePose {
    Vec2 position, end_position;  // m
    Rotation turn, end_turn;
    double angle = 0, end_angle = 0;  // rad
    bool takes_part = true;           // false: quarantined
    std::uint32_t row = 0;

    bool turns() const { return angle != end_angle; }
};

/// The turn at a share of the step.
inline Rotation turn_at(const EdgePose& pose, double share) {
    if (!pose.turns()) return pose.turn;
    return rotation_by(pose.angle + share * (pose.end_angle - pose.angle));
}

/// A disc and an edge that can touch.
struct EdgePair {
    std::int32_t row;   // of the disc
    std::int32_t edge;  // in the EdgeStore

    friend auto operator<=>(const EdgePair&, const EdgePair&) = default;
};

/// Which discs can touch which edges. They are found together with the candidate pairs of discs and hold as
/// long as these do: discs have margins of their own there. Edges that move have a margin too; when one of
/// them has used it up, all candidates are void.
template <class Real>
class EdgeCandidates {
  public:
    /// To be called first in every step: where edges are at its start and, after dt [s], at its end.
    /// Cost: O(bodies with edges that move, and those that were joined or parted); about 1 ns for each of the
    /// others when rows have been forgotten.
    void place(const WorldState<Real>& world, double dt);
    /// To be called when rows have changed.
    void forget_rows() { are_rows_known_ = false; }
    /// To be called when bodies have got to the end of the step: where edges are then, after rounding. That
    /// of an angle of 200 rad is 1e-5 rad in single precision, 7 cm at the rim of a drum of 7 km.
    void settle(const WorldState<Real>& world);
    /// Whether some edge leaves the margin with which its discs were found, before the end of the step.
    bool has_left_margin(const WorldState<Real>& world) const;

    /// Finds all discs that can touch an edge, by edge, in an order that depends on the input alone.
    /// In a world without edges there are none: those found before are forgotten.
    /// Cost: O(edges + their length / radii + what is found); where more bodies with edges stand than there
    /// are that move, O(those that move + what is found) for what stands; of a chain with more edges than
    /// there are bodies, O(bodies log edges + what is found).
    void find(const WorldState<Real>& world, const Candidates<Real>& candidates);
    std::span<const EdgePair> pairs() const { return pairs_; }  ///< by row, then by edge

    /// Rows have changed: pairs of what is gone or elsewhere go, those of other rows follow.
    /// @param now  present row of each former one, or negative  @param is_elsewhere  a present row
    void follow_rows(std::span<const std::int32_t> now, std::span<const std::uint8_t> is_elsewhere);
    /// Whether edges that leave their margins may get new ones, with what they reach besides; else everything
    /// is to be found anew.
    bool may_add() const { return 2 * added_ <= pairs_.size() + kFewAdded; }

    /// Adds what discs reach with new margins that they got in this step. Cost: O(strays), and O(bodies with
    /// edges that move + log edges + what is found) for each that has got far; likewise O(what is found) for
    /// each edge that has left its margin.
    void add_strays(const WorldState<Real>& world, const Candidates<Real>& candidates);
    /// The pairs that the last call of add_strays added.
    std::span<const EdgePair> new_pairs() const { return new_pairs_; }

    /// How much farther than its first reach a disc was looked for [m].
    double allowance() const { return allowance_; }

    /// Whether segments or chains of more than one edge stand.
    bool have_standing_tracks() const { return have_standing_tracks_; }

    const EdgePose& pose_of(const Edge& edge) const { return poses_[static_cast<std::size_t>(edge.body)]; }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.found_at_, self.pairs_, self.new_pairs_, self.allowance_, self.added_);
        if constexpr (!std::is_const_v<Self>) self.are_placed_ = self.are_rows_known_ = false;
    }

    std::size_t bytes() const {
        return poses_.capacity() * sizeof(EdgePose) + found_at_.capacity() * sizeof(FoundAt) +
               (pairs_.capacity() + new_pairs_.capacity() + unsorted_.capacity()) * sizeof(EdgePair) +
               first_of_row_.capacity() * sizeof(std::uint32_t) + near_.bytes() +
               near_bodies_.capacity() * sizeof(std::int32_t);
    }

  private:
    struct FoundAt {
        Vec2 position;
        Rotation turn;
        double angle = 0, reach = 0, margin = 0;  // rad, m, m
    };
    /// Whether the filters of a body and of the body of an edge keep them apart.
    bool is_forbidden(const WorldState<Real>& world, std::int32_t row, const EdgePose& pose) const {
        return world.has_filters() && !world.may_collide(static_cast<std::size_t>(row), pose.row);
    }
    static constexpr std::size_t kFewAdded = 256;

    void find_rows(const WorldState<Real>& world);
    void place_body(const WorldState<Real>& world, double dt, std::size_t body);
    bool has_left_margin(std::size_t mover, std::size_t body) const;
    void give_margin(const WorldState<Real>& world, const Candidates<Real>& candidates, std::size_t mover,
                     std::size_t body);
    void add_around_edges(const WorldState<Real>& world, const Candidates<Real>& candidates, std::size_t body,
                          double margin);
    void add_pair(EdgePair pair);
    void sort_pairs(std::size_t rows);
    void find_of_body(const WorldState<Real>& world, const Candidates<Real>& candidates, std::size_t body,
                      double margin, double largest_reach);
    void find_standing(const WorldState<Real>& world, const Candidates<Real>& candidates, double margin);
    void find_near_discs(const WorldState<Real>& world, const Candidates<Real>& candidates, std::size_t body,
                         double margin);
    void find_near_disc(const WorldState<Real>& world, std::int32_t disc, Vec2 place, double reach,
                        std::size_t body);
    void find_near_edge(const WorldState<Real>& world, const Candidates<Real>& candidates, std::int32_t edge,
                        double margin, double largest_reach);

    std::vector<EdgePose> poses_;    // a body of the EdgeStore
    std::vector<FoundAt> found_at_;  // one of EdgeStore::movers; what stands is found where it is
    bool are_placed_ = false, are_rows_known_ = false, have_standing_tracks_ = false;
    std::vector<std::int32_t> near_bodies_;
    std::vector<EdgePair> pairs_, new_pairs_;
    std::vector<EdgePair> unsorted_;           // scratch of sort_pairs
    std::vector<std::uint32_t> first_of_row_;  // likewise
    std::size_t added_ = 0;                    // pairs since they were found
    double allowance_ = 0;                     // m, that a disc's reach may grow beyond what was looked at
    Column<std::int32_t> near_;
};

extern template class EdgeCandidates<float>;
extern template class EdgeCandidates<double>;

}  // namespace carom

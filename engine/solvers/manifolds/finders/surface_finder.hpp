#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/edge_candidates.hpp"
#include "narrowphase/convex_edge.hpp"
#include "narrowphase/convex_impact_time.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/manifolds/meetings/held_flights.hpp"
#include "solvers/manifolds/poses/contact_distance.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Contacts of convex shapes with what is no body: walls, and the edges of segments and chains, in double
/// precision. What touches a wall is found anew in every step; what touches edges that stand is carried on
/// while the body has hardly moved, as contacts of two bodies are (pose_watch.hpp).
template <class Real>
class SurfaceFinder {
  public:
    /// Takes the edges over that bodies can touch until candidate pairs change.
    void renew(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);
    /// Edges are other ones: what touches them is found anew.
    void clear() { pairs_.clear(), groups_.clear(); }
    /// Adds what came with new margins.
    void add(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);
    /// Whether nothing can be found.
    bool is_idle(const WorldState<Real>& world) const { return pairs_.empty() && !world.walls; }

    struct Inputs {
        const WorldState<Real>& world;
        const EdgeCandidates<Real>& edges;
        const SubstepTerms& terms;
        const ContactDistance& near;
        const PoseWatch<Real>& poses;
        const HeldFlights<Real>& flights;
        std::span<const double> ahead;  ///< s, by row: how far ahead of the start a body is to be looked for
        const ManifoldList<Real>& before;  ///< the contacts of the step before
    };
    /// Lists the contacts of the step, with what they are like, by body. The memory of those that were found
    /// is empty.
    /// Cost: 1 ns a body where there are walls; about 200 ns a body near a wall or a chain.
    void find(const Inputs& in, ManifoldList<Real>& list, const Executor& executor);

    /// The contact of the step before that contact i of the list is; below zero: it was found in this step.
    std::int32_t carried_from(std::size_t i) const { return carried_from_[i]; }
    bool some_are_carried() const { return some_are_carried_; }
    /// Whether all that are carried on have the numbers that they had.
    bool keep_numbers() const { return keep_numbers_; }
    /// Calls fn(row) for each body that is near an edge, whatever it touches.
    template <class Fn>
    void for_each_near_edges(const Fn& fn) const {
        for (const Group& group : groups_) fn(static_cast<std::size_t>(group.row));
    }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.pairs_, self.groups_);
    }

  private:
    /// An edge that a body can touch; those of one chain stand together.
    struct Near {
        std::int32_t row, track, edge;  // track: EdgeStore::track_of its body
        friend auto operator<=>(const Near&, const Near&) = default;
    };
    /// A body and the near edges of one chain or track, and what of the list touches there.
    struct Group {
        std::int32_t row, track;
        std::int32_t first_contact, contacts;
        bool is_same_pair(const Group& other) const { return row == other.row && track == other.track; }
        bool is_before(const Group& other) const {
            return row != other.row ? row < other.row : track < other.track;
        }
    };
    void take_over(const WorldState<Real>& world, std::span<const EdgePair> pairs);
    bool may_carry(const Inputs& in, const EdgePose& pose, std::size_t row) const;
    void carry(const Inputs& in, const Group& group, ManifoldList<Real>& list);
    void list_near_walls(const Inputs& in, const Executor& executor);
    void find_walls(const Inputs& in, ManifoldList<Real>& list);
    void find_edges(const Inputs& in, ManifoldList<Real>& list);
    void find_on_edges(const Inputs& in, const EdgePose& pose, std::span<const Near> pairs,
                       ManifoldList<Real>& list);
    void list_near_edges(const Inputs& in, const EdgePose& pose, std::size_t row,
                         std::span<const Near> pairs);
    void find_on_chain(const Inputs& in, const EdgePose& pose, std::size_t row,
                       const ConvexShape<Real>& shape, std::int32_t number, const StoredPiece* piece,
                       ManifoldList<Real>& list);
    double time_of_meeting_edges(const WorldState<Real>& world, const MovingConvex& body, double way,
                                 double dt, double thickness) const;

    std::vector<Near> pairs_;
    std::vector<Group> groups_;  // of the last list, by row and track
    ChunkedList rows_near_walls_;
    // Scratch of one contact after the other.
    std::vector<std::int32_t> near_edges_;
    std::vector<ChainManifold> found_;
    std::vector<Manifold<double>> manifolds_;  // of the contacts of the list
    std::vector<const StoredPiece*> pieces_;   // likewise; null: of what is no compound
    std::vector<std::int32_t> carried_from_;   // likewise
    bool some_are_carried_ = false, keep_numbers_ = true;
    std::vector<Group> groups_before_;
};

extern template class SurfaceFinder<float>;
extern template class SurfaceFinder<double>;

}  // namespace carom

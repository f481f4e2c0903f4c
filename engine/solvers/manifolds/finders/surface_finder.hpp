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

/// Contacts of convex shapes with what is no body: walls, and the edges of segments and chains. What touches
/// is found anew in every step, in double precision: they are few.
template <class Real>
class SurfaceFinder {
  public:
    /// Takes the edges over that bodies can touch until candidate pairs change.
    void renew(const WorldState<Real>& world, const EdgeCandidates<Real>& edges);
    void clear() { pairs_.clear(); }
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
    };
    /// Lists the contacts of the step, with what they are like, by body. Their memory is empty.
    /// Cost: 1 ns a body where there are walls; about 200 ns a body near a wall or a chain.
    void find(const Inputs& in, ManifoldList<Real>& list, const Executor& executor);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.pairs_);
    }

  private:
    /// An edge that a body can touch; those of one chain stand together.
    struct Near {
        std::int32_t row, track, edge;  // track: EdgeStore::track_of its body
        friend auto operator<=>(const Near&, const Near&) = default;
    };
    void take_over(const WorldState<Real>& world, std::span<const EdgePair> pairs);
    void list_near_walls(const Inputs& in, const Executor& executor);
    void find_walls(const Inputs& in, ManifoldList<Real>& list);
    void find_edges(const Inputs& in, ManifoldList<Real>& list);
    void leave_out_distant(const Inputs& in, const EdgePose& pose, std::size_t row);
    void find_on_chain(const Inputs& in, const EdgePose& pose, std::size_t row,
                       const ConvexShape<Real>& shape, std::int32_t number, const StoredPiece* piece,
                       ManifoldList<Real>& list);
    double time_of_meeting_edges(const WorldState<Real>& world, const MovingConvex& body, double way,
                                 double dt, double thickness) const;

    std::vector<Near> pairs_;
    ChunkedList rows_near_walls_;
    // Scratch of one contact after the other.
    std::vector<std::int32_t> near_edges_;
    std::vector<ChainManifold> found_;
    std::vector<Manifold<double>> manifolds_;  // of the contacts of the list
    std::vector<const StoredPiece*> pieces_;   // likewise; null: of what is no compound
};

extern template class SurfaceFinder<float>;
extern template class SurfaceFinder<double>;

}  // namespace carom

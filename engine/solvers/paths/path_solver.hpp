#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "broadphase/edge_candidates.hpp"
#include "constraints/partner.hpp"
#include "kernels/path_arguments.hpp"
#include "sleeping/sleepers.hpp"
#include "solvers/paths/manifold_list.hpp"
#include "solvers/paths/path_cut.hpp"
#include "solvers/paths/surface_finder.hpp"
#include "solvers/substeps/body_records.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/world_state.hpp"

namespace carom {

/// What the solver of paths counts, of the last step.
struct PathCounters {
    std::int64_t contacts = 0;   ///< that can touch
    std::int64_t bundles = 0;    ///< of paths
    std::int64_t links = 0;      ///< of bundles: kPathLanes times as many places for contacts
    std::int64_t unsettled = 0;  ///< paths whose active set did not settle, in all substeps
    std::int64_t impacts = 0;    ///< so far
    std::int64_t cuts = 0;       ///< steps that cut the contacts into paths anew, so far
};

/// A contact in its place along a path.
template <class Real>
struct PathContact {
    const PathLink<Real>& link;
    std::size_t lane;
    std::int32_t near, far;  ///< rows in the records; those of what nothing moves are beyond the bodies
    Partner partner;         ///< b of the contact
    bool is_reversed;        ///< the near body is b, not a
    double restitution;
};

/// The contacts of convex shapes that are no discs: what can touch, what does, and the impulses, solved
/// exactly along paths of contacts.
///
/// Cost: docs/decisions/0027-paths-of-contacts.md.
template <class Real>
class PathSolver {
  public:
    PathCounters counters;

    /// Whether no contact can come about.
    bool is_idle(const WorldState<Real>& world) const {
        return bodies_.count() == 0 && surface_finder_.is_idle(world);
    }

    /// Lists what can touch, when candidate pairs have been found anew.
    void renew(const WorldState<Real>& world, const Candidates<Real>& candidates,
               const EdgeCandidates<Real>& edges, std::span<const SleeperPair> sleepers);
    /// Adds the pairs that have come with new margins.
    void add(const WorldState<Real>& world, const Candidates<Real>& candidates,
             const EdgeCandidates<Real>& edges);
    /// Forgets the impulses, or rescales them to substeps of another length.
    void rescale(double factor);
    /// Finds the contacts of the step and lays them out along paths.
    void find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges, const SubstepTerms& terms,
              const ContactDistance& near, BodyRecords<Real>& records, const StepLoops<Real>& loops);
    /// Gives the bodies the impulses of the step before.
    void warm_start(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops);
    /// Solves a substep.
    /// @param passes  times that the paths are solved; more than one where there are no impulses to start
    /// from
    /// @param sweeps  whether to sweep over all contacts at the end
    void solve(const SubstepTerms& terms, BodyRecords<Real>& records, const StepLoops<Real>& loops,
               int passes, bool sweeps);
    /// Moves the surfaces of kinematic bodies on by a substep.
    void advance(const SubstepTerms& terms, BodyRecords<Real>& records);
    /// Calls fn(contact) for each PathContact of the step.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for (std::size_t n = 0; n < live_.size(); ++n) {
            const ManifoldList<Real>& list = live_[n] >= 0 ? bodies_ : surfaces_;
            const std::size_t i = place_of(live_[n]);
            const typename PathCut::Place place = cut_.places()[n];
            fn(PathContact<Real>{links_[place.link], place.lane, near_row(place),
                                 links_[place.link].body[place.lane], Partner(list.b[i]), place.is_reversed,
                                 static_cast<double>(list.restitution[i])});
        }
    }
    /// The contacts that carry an impulse at the end of a step, for those who look after sleepers.
    std::span<const LoadedContact> loaded();
    /// Keeps the impulses for the next step.
    void end();

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.counters, self.bodies_, self.surfaces_, self.surface_finder_, self.asleep_,
                self.asleep_then_, self.live_, self.blocks_are_boxes_, self.cut_, self.since_cut_,
                self.solved_, self.is_calm_, self.is_cut_calm_);
    }

  private:
    using Pass = typename PathKernels<Real>::Pass;

    SolvePaths<Real> arguments(const SubstepTerms& terms, BodyRecords<Real>& records);
    void run(Pass pass, SolvePaths<Real> arguments, const StepLoops<Real>& loops);
    void keep_of_sleepers(const WorldState<Real>& world);
    /// Adds a pair of which not both are discs, if both are boxes or not both, as `boxes` says.
    void add_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b, bool boxes);
    void list_boxes(const ShapeStore<Real>& shapes);
    void find_box_blocks(const Bodies<Real>& bodies, std::size_t first);
    void recall(ManifoldList<Real>& list, const ManifoldList<Real>& old);
    void file_by_slot(const ManifoldList<Real>& old);
    void recall_surfaces();
    void pose_bodies(const WorldState<Real>& world);
    bool list_live();
    void note_calm();
    /// Row of the body where a link begins.
    std::int32_t near_row(PathCut::Place place) const {
        const bool is_first = place.link == cut_.first_link()[place.bundle];
        return is_first ? heads_[kPathLanes * place.bundle + place.lane]
                        : links_[place.link - 1].body[place.lane];
    }
    void cut_paths(const WorldState<Real>& world);
    void lay_out(const WorldState<Real>& world, const EdgeCandidates<Real>& edges, BodyRecords<Real>& records,
                 const StepLoops<Real>& loops);
    void fill_link(const WorldState<Real>& world, const BodyRecords<Real>& records, std::size_t number);

    /// A contact by its number in live_: from 0 on those of bodies_, below 0 those of surfaces_.
    ManifoldList<Real>& list_of(std::int32_t contact) { return contact >= 0 ? bodies_ : surfaces_; }
    static std::size_t place_of(std::int32_t contact) {
        return static_cast<std::size_t>(contact >= 0 ? contact : ~contact);
    }

    ManifoldList<Real> bodies_;    // contacts of two bodies
    ManifoldList<Real> surfaces_;  // of a body and a wall or an edge
    ManifoldList<Real> old_;
    /// Contacts of bodies that sleep, or slept when candidates were found last.
    std::vector<KeptManifold<Real>> asleep_;
    std::size_t asleep_then_ = 0;  // bodies that slept then
    SurfaceFinder<Real> surface_finder_;
    ManifoldList<Real> old_surfaces_;
    std::vector<std::uint8_t> is_recalled_;  // by contact of old_
    std::vector<LoadedContact> loaded_;
    std::vector<std::uint8_t> is_box_of_;                     // by shape
    std::vector<std::uint8_t> blocks_are_boxes_;              // by block of kRowPadding contacts of bodies_
    std::vector<std::int32_t> first_of_slot_, next_of_slot_;  // contacts of old_ by the slot of their a
    Column<Real> pose_;                                       // [rows][4]: x, y [m], cosine, sine
    Column<double> pose_angle_;                               // rad, that cosine and sine are of
    std::vector<std::int32_t> live_, was_live_;               // contacts that can touch in this step
    std::vector<std::int32_t> row_of_far_;                    // of each of live_: the row of b in the records
    std::vector<ContactLink> contact_links_;
    PathCut cut_;
    int since_cut_ = 0;        // steps
    std::int64_t solved_ = 0;  // paths, in the substeps of the last step
    bool is_calm_ = true;      // paths settle
    bool is_cut_calm_ = true;  // when they were cut
    Column<PathLink<Real>> links_;
    Column<std::int32_t> heads_;
    std::size_t first_still_row_ = 0;  // in the records: of padding and of what nothing moves
    Column<std::byte> scratch_;
};

extern template class PathSolver<float>;
extern template class PathSolver<double>;

}  // namespace carom

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "broadphase/edge_candidates.hpp"
#include "sleeping/sleepers.hpp"
#include "solvers/manifolds/finders/distant_pairs.hpp"
#include "solvers/manifolds/finders/gaps.hpp"
#include "solvers/manifolds/finders/poses_ahead.hpp"
#include "solvers/manifolds/finders/surface_finder.hpp"
#include "solvers/manifolds/list/live_contacts.hpp"
#include "solvers/manifolds/list/manifold_index.hpp"
#include "solvers/manifolds/list/manifold_list.hpp"
#include "solvers/manifolds/meetings/held_flights.hpp"
#include "solvers/manifolds/poses/contact_distance.hpp"
#include "solvers/manifolds/poses/piece_items.hpp"
#include "solvers/manifolds/poses/pose_watch.hpp"
#include "solvers/substeps/step_terms.hpp"
#include "state/columns/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// A world of fewer contacts is small: one contact that comes late, as in a row of dominoes, would change it.
/// docs/decisions/0043-contacts-beside-paths.md, 0055-heaps-that-fall.md.
inline constexpr std::size_t kContactsOfSmallWorld = 1024;
/// Contacts for each body in a heap, about.
inline constexpr std::size_t kContactsOfBody = 2;

/// The contacts of convex shapes that are no discs: which can come about, which do in a step, and the
/// impulses that they keep from step to step. A contact is known by the handles of its bodies, so that rows
/// may change.
///
/// Pairs that are too far apart to touch wait aside (distant_pairs.hpp). Contacts of bodies that have hardly
/// moved since are carried on (pose_watch.hpp), in blocks of kRowPadding.
///
/// Cost: about 30 ns a near pair when candidate pairs are found anew; 10 ns a pair that is found, and step.
template <class Real>
class Manifolds {
  public:
    /// Lists what can touch, when candidate pairs have been found anew.
    void renew(const WorldState<Real>& world, const Candidates<Real>& candidates,
               const EdgeCandidates<Real>& edges, std::span<const SleeperPair> sleepers,
               const Executor& executor);
    /// Forgets all contacts.
    void clear() {
        distant_.clear(), bodies_.clear(), surfaces_.clear(), live_.clear(), surface_finder_.clear();
        is_renewed_ = false;
    }
    /// Adds the pairs that have come with new margins.
    void add(const WorldState<Real>& world, const Candidates<Real>& candidates,
             const EdgeCandidates<Real>& edges);
    /// Follows rows that changed, the edges that bodies are near to with them. Contacts stay with their
    /// bodies, and only those that stood in the same blocks as one that is gone are found anew. Where bodies
    /// sleep pairs are to be found anew instead. Cost: O(bodies + pairs), about 2 ns each.
    /// @param now  present row of each former one, or negative
    /// @param is_elsewhere  a present row, whether its body was put elsewhere
    bool may_follow_rows(const WorldState<Real>& world) const {
        return items_.empty() == !world.shapes.has_compounds();
    }
    void follow_rows(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                     std::span<const std::int32_t> now, std::span<const std::uint8_t> is_elsewhere);
    /// Forgets the impulses, or rescales them to substeps of another length.
    void rescale(double factor);
    /// Finds the contacts of the step.
    /// @return whether they are those of the step before
    bool find(const WorldState<Real>& world, const EdgeCandidates<Real>& edges, const SubstepTerms& terms,
              const ContactDistance& near, const StepLoops<Real>& loops);

    /// The contacts that can touch in this step. From 0 on they are of two bodies, below 0 of a body and a
    /// wall or an edge.
    std::span<const std::int32_t> live() const { return live_.numbers(); }
    /// Places in `live` of those that were found in this step, in order; the others have been carried on.
    std::span<const std::int32_t> found() const { return live_.found(); }
    /// Whether there are so many that the world is not small.
    bool is_crowd() const { return live().size() >= kContactsOfSmallWorld; }
    ManifoldList<Real>& list_of(std::int32_t contact) { return contact >= 0 ? bodies_ : surfaces_; }
    const ManifoldList<Real>& list_of(std::int32_t contact) const {
        return contact >= 0 ? bodies_ : surfaces_;
    }
    static std::size_t place_of(std::int32_t contact) {
        return static_cast<std::size_t>(contact >= 0 ? contact : ~contact);
    }
    /// Whether a live contact was found in this step; else it has been carried on.
    bool is_found(std::int32_t contact) const {
        return contact < 0 ? surface_finder_.carried_from(place_of(contact)) < 0
                           : block_is_found_[place_of(contact) / kRowPadding] != 0;
    }
    /// Whether some were carried on.
    bool some_are_carried() const {
        return surface_finder_.some_are_carried() || found_blocks_.size() < block_is_found_.size();
    }
    /// Contacts of two bodies that have come or gone since the step before, as a share of those there are;
    /// negative where that is not known, since pairs have been found anew.
    double changed_share() const { return live_.changed_share(); }
    /// What bodies have come in the step before.
    PoseWatch<Real>& poses() { return poses_; }
    ManifoldMemory<Real>& memory_of(std::int32_t contact) {
        return list_of(contact).memory[place_of(contact)];
    }
    /// The contacts that carry an impulse at the end of a step, for what looks after sleepers.
    std::span<const LoadedContact> loaded();

    /// Number of the geometry that an item of a body has: the body's, or a piece's.
    std::int32_t shape_of_item(const WorldState<Real>& world, std::size_t row, std::int32_t item) const {
        return items_.shape_of(world, static_cast<std::int32_t>(row), item);
    }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.items_, self.distant_, self.bodies_, self.surfaces_, self.surface_finder_, self.asleep_,
                self.asleep_then_, self.live_, self.blocks_are_boxes_, self.poses_, self.found_within_,
                self.first_new_block_);
        if constexpr (!std::is_const_v<Self>) self.shapes_of_boxes_ = 0, self.is_renewed_ = false;
    }

  private:
    bool is_idle(const WorldState<Real>& world) const {
        return bodies_.count() == 0 && distant_.empty() && !is_renewed_ && surface_finder_.is_idle(world);
    }
    void keep_of_sleepers(const WorldState<Real>& world);
    /// Whether a candidate pair can touch; not if both are discs.
    bool can_touch(const WorldState<Real>& world, std::int32_t a, std::int32_t b) const;
    /// Notes a candidate pair that can touch.
    void list_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b);
    /// Adds the pairs that have come near; those of before have what they had.
    void take_near(const WorldState<Real>& world, double dt, const ContactDistance& near,
                   const StepLoops<Real>& loops);
    void add_pair(const WorldState<Real>& world, std::int32_t a, std::int32_t b);
    bool are_boxes(const Bodies<Real>& bodies, std::int32_t a, std::int32_t b) const;
    void read_shapes(const ShapeStore<Real>& shapes);
    void find_box_blocks(const Bodies<Real>& bodies, std::size_t first);
    void recall(ManifoldList<Real>& list, const ManifoldList<Real>& old, const Executor& executor);
    void recall_surfaces();
    void choose_blocks(const Executor& executor);
    std::optional<std::span<const std::int32_t>> rows_to_find(const WorldState<Real>& world);
    /// Finds how bodies fly that surfaces and standing bodies hold.
    void find_flights(const Gaps<Real>& gaps, const WorldState<Real>& world, double dt,
                      const Executor& executor);
    bool must_find(std::size_t block) const;
    void note_thicknesses(std::size_t first);
    void describe_pairs(const WorldState<Real>& world, const ContactDistance& near, std::size_t first,
                        std::size_t last);
    void describe_pieces(const WorldState<Real>& world, const ContactDistance& near, std::size_t i);
    void find_pairs(const WorldState<Real>& world, const SubstepTerms& terms,
                    const ConvexKernels<Real>& kernels, std::size_t block);
    /// Tells live_ of a block that was found, and forgets the impulses of what cannot touch.
    void note_live(std::size_t block);
    std::uint32_t live_then(std::size_t block) const;

    PieceItems<Real> items_;
    DistantPairs<Real> distant_;
    bool is_renewed_ = false;      // in this step
    ChunkedList chosen_pairs_;     // of the candidates, those that can touch
    ManifoldList<Real> bodies_;    // contacts of two bodies
    ManifoldList<Real> surfaces_;  // of a body and a wall or an edge, of the last step
    ManifoldList<Real> old_, old_surfaces_;
    SurfaceFinder<Real> surface_finder_;
    /// Contacts of bodies that slept when candidates were found last.
    std::vector<KeptManifold<Real>> asleep_;
    std::size_t asleep_then_ = 0;  // bodies that slept then
    LiveContacts live_;
    std::vector<LoadedContact> loaded_;
    std::vector<std::uint8_t> is_box_of_;         // by shape
    std::uint64_t shapes_of_boxes_ = 0;           // ShapeStore::revision of these shapes
    std::vector<std::uint8_t> blocks_are_boxes_;  // by block of kRowPadding contacts of bodies_
    PoseWatch<Real> poses_;
    PosesAhead<Real> ahead_;
    HeldFlights<Real> flights_;
    ChunkedList holding_;  // contacts that hold their bodies a
    /// What contacts are found within, by block of the last step; all zero: all are to be found anew.
    struct Within {
        double share = 0, fall = 0, dt = 0;  // ContactDistance; s
        friend bool operator==(const Within&, const Within&) = default;
    };
    Within found_within_;
    std::size_t first_new_block_ = 0;  // blocks from here on are to be found, whatever their bodies do
    std::vector<std::uint8_t> is_changed_block_;  // some contact in it is another one than in the last step
    std::vector<std::uint8_t> block_is_found_;
    std::vector<std::uint32_t> found_blocks_;  // numbers of those
    std::vector<std::int32_t> rows_;           // of rows_to_find
    std::vector<std::uint8_t> is_listed_;      // by row: whether it is among them
    // Scratch of `recall`.
    ManifoldIndex index_;                    // of old contacts
    std::vector<std::uint8_t> is_recalled_;  // by old contact
};

extern template class Manifolds<float>;
extern template class Manifolds<double>;

}  // namespace carom

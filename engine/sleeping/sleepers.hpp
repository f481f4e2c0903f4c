#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "constraints/contact_graph.hpp"
#include "sleeping/islands.hpp"
#include "sleeping/sleeper_grid.hpp"
#include "state/world_state.hpp"

namespace carom {

/// A contact that carries an impulse, of shapes that the contact graph does not know.
struct LoadedContact {
    std::int32_t a;  // row
    Partner b;
    double impulse;  // N s, along the normal, of a substep
};

/// The bodies that sleep: rows behind those that a step works on. They stand in a grid of their own, which
/// those awake look into when their candidate pairs are found; to them a sleeper is a support.
///
/// An island sleeps as a whole and wakes as a whole, with the forces its contacts had.
/// Rules and derivations: docs/decisions/0010-sleeping.md.
template <class Real>
class Sleepers {
  public:
    // At the start of a step.

    /// Finds the pairs anew if the candidate pairs were. Cost: O(rows awake) then, O(sleepers) if those have
    /// changed.
    void find_pairs(const WorldState<Real>& world, const Candidates<Real>& candidates,
                    const KernelTable<Real>& kernels, const Executor& executor);
    std::span<const SleeperPair> pairs() const { return pairs_; }
    /// Whether any of these rows, whose margins are new, comes near a sleeper.
    bool is_near_any(const WorldState<Real>& world, const Candidates<Real>& candidates,
                     std::span<const std::int32_t> rows);
    /// To be called before rows get another order: contacts with sleepers keep no impulses.
    static void forget_contacts(ContactGraph<Real>& graph);
    /// Marks the islands that something is about to hit in this step, and those that these hit in turn.
    /// @return whether there are any.
    bool mark_hit(const WorldState<Real>& world, double dt, double substep);
    /// Gives contacts that have woken the impulses of a substep of length `substep`.
    void restore_impulses(ContactGraph<Real>& graph, const WorldState<Real>& world, double substep);

    // At its end.

    /// Rows of sleepers around which the disc comes within `reach` [m] of a place, and of some more. Valid
    /// until the next call.
    std::span<const std::int32_t> around(const WorldState<Real>& world, Vec2 place, double reach,
                                         const KernelTable<Real>& kernels, const Executor& executor) {
        if (world.bodies.asleep == 0) return {};
        grid_.build(world, kernels, executor);
        return grid_.near(world, place, reach);
    }

    /// Marks the islands that something presses on.
    /// @param others  contacts besides those of the graph, here and below
    /// @return whether there are any.
    bool mark_pressed(const WorldState<Real>& world, const ContactGraph<Real>& graph,
                      std::span<const LoadedContact> others, double substep);
    /// Counts for how long each body has been still, and puts islands to sleep all of whose bodies have been
    /// so for long enough.
    /// @return whether rows have changed.
    bool put_to_sleep(WorldState<Real>& world, ContactGraph<Real>& graph,
                      std::span<const LoadedContact> others, double dt, double substep);

    // At any time.

    void mark(std::int32_t island) { marked_.push_back(island); }
    /// Marks the islands of sleepers within `reach` of a place, and a little more. @return whether there are
    /// any.
    bool mark_near(const WorldState<Real>& world, Vec2 place, double reach, const KernelTable<Real>& kernels,
                   const Executor& executor);
    bool mark_all(const WorldState<Real>& world);
    /// Wakes the islands that are marked. @return how many rows woke: the last of those awake.
    std::size_t wake_marked(WorldState<Real>& world);

    /// Forgets the forces of those that have woken since the last step.
    void forget_woken() { woken_.clear(); }

    std::int64_t island_count() const { return island_count_; }
    std::int64_t woken_count() const { return woken_count_; }
    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.kept_, self.woken_, self.marked_, self.pairs_, self.pairs_of_rebuild_,
                self.next_island_);
        archive(self.island_count_, self.woken_count_, self.since_look_, self.waiting_, self.grid_);
    }
    /// To be called after the state was read.
    void use(const KernelTable<Real>& kernels) { grid_.use(kernels); }

  private:
    /// A contact of an island that sleeps.
    struct Kept {
        std::int32_t island;
        BodyId a, b;
        std::int32_t support;              // a wall or an edge in place of b, else 0
        double normal, friction, rolling;  // N
    };
    /// A contact that has woken, by its rows.
    struct Woken {
        std::int32_t a, b;
        std::size_t number;  // in woken_
        friend auto operator<=>(const Woken&, const Woken&) = default;
    };
    /// A row that leans on a sleeper.
    struct Held {
        std::int32_t row, island;
    };

    /// A sleeper that something comes to, and how fast it may move then.
    struct Hit {
        double left;   // s, of the time looked ahead: how long it moves
        double speed;  // m/s
        std::int32_t sleeper;
        /// The first to be hit is the largest; rows decide between equals, so that order does not.
        friend bool operator<(const Hit& a, const Hit& b) {
            return a.left != b.left ? a.left < b.left : a.sleeper > b.sleeper;
        }
    };

    void hand_on_hits(const WorldState<Real>& world, double gravity, double substep);
    bool note_still(WorldState<Real>& world, double dt, double substep) const;
    void connect(const WorldState<Real>& world, const ContactGraph<Real>& graph,
                 std::span<const LoadedContact> others);
    void keep_contacts(const WorldState<Real>& world, ContactRows<Real>& contacts, double substep);
    void keep_contact(const WorldState<Real>& world, const ContactRows<Real>& contacts, std::size_t i,
                      double substep);
    void lay_down(WorldState<Real>& world, std::size_t row);
    void rename_island(WorldState<Real>& world, std::int32_t from, std::int32_t to);

    std::vector<Kept> kept_, woken_;
    std::vector<Woken> filed_;
    std::vector<std::int32_t> marked_;
    std::vector<SleeperPair> pairs_;
    std::int64_t pairs_of_rebuild_ = -1;
    std::int32_t next_island_ = 0;
    std::int64_t island_count_ = 0, woken_count_ = 0;
    double since_look_ = 0;  // s
    double waiting_ = 0;  // bodies that could sleep, added up over the looks since the last that fell asleep
    SleeperGrid<Real> grid_;

    // Scratch of `mark_hit`.
    std::vector<Hit> hits_;                // a heap
    std::vector<std::uint8_t> is_handed_;  // by sleeper: whether what hit it was handed on

    // Scratch of `connect` and `put_to_sleep`.
    Islands islands_;
    std::vector<std::uint8_t> stays_awake_;  // by row: whether an island does, at its smallest row
    std::vector<std::int32_t> label_;  // by row: number of an island that falls asleep, at its smallest row
    std::vector<Held> leaning_;
    std::vector<std::int32_t> order_;  // row before the exchanges, of each row
};

extern template class Sleepers<float>;
extern template class Sleepers<double>;

}  // namespace carom

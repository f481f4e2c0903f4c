#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "broadphase/edge_candidates.hpp"
#include "constraints/contact_rows.hpp"
#include "constraints/crowds.hpp"
#include "constraints/impulse_memory.hpp"
#include "constraints/lost_contacts.hpp"
#include "constraints/rolling_memory.hpp"
#include "constraints/row_renaming.hpp"
#include "constraints/task_groups.hpp"
#include "parallel/executor.hpp"
#include "state/bodies.hpp"
#include "state/world_state.hpp"

namespace carom {

/// A body that is awake, or kinematic, and one that sleeps, near enough to touch before the pairs are void.
struct SleeperPair {
    std::int32_t row, sleeper;
};

/// Which discs can touch which, and what supports discs, in groups and colours, until the candidate pairs
/// change.
///
/// Colouring is greedy in the order of the pairs, group by group, which depends on the input alone. It is
/// done anew with the candidate pairs, because then the pairs change throughout; between rebuilds nothing is
/// done.
template <class Real>
class ContactGraph {
  public:
    static constexpr std::size_t kColours = 64;  // one bit each of a word a body

    /// Takes the candidate pairs over. Contacts that were there before keep their impulses.
    /// Cost: about 20 ns a pair on one thread.
    void renew(const Candidates<Real>& candidates, const EdgeCandidates<Real>& edges,
               const Bodies<Real>& bodies, const Walls* walls, const Executor& executor);

    /// Adds the pairs that have come with new margins, and walls and edges that these reach: to the last
    /// groups. Cost: O(contacts of those groups) if there are any.
    void add(const Candidates<Real>& candidates, const EdgeCandidates<Real>& edges,
             const Bodies<Real>& bodies, const Walls* walls);

    /// Follows rows that were removed, added or put elsewhere since the last renewal without finding pairs
    /// anew: contacts that are gone leave their colours, and those of bodies with a new row go to the last
    /// groups. Cost: O(rows + contacts), about 1 ns each, and O(contacts of the last groups).
    /// @param is_elsewhere  a present row, whether its body was put elsewhere: its contacts are gone
    void follow_rows(const Bodies<Real>& bodies, std::span<const std::uint8_t> is_elsewhere);

    bool keeps_rolling = false;                ///< rolling impulses, too
    const WorldState<Real>* filter = nullptr;  ///< pairs that it forbids are left out; null: none
    std::int64_t renewals = 0;                 ///< so many times pairs were found anew
    std::int64_t version = 0;                  ///< counts renewals and additions
    std::span<const SleeperPair> sleepers;     ///< supports besides those that `renew` finds
    RowRenaming trail;                         ///< to be told of rows that change between renewals
    std::vector<LostContact> lost;             ///< that pushed, until they are dealt with
    std::vector<FormerPlace> former_places;    ///< of bodies that are gone since the trail started
    TaskGroups groups;                         ///< of the last renewal
    ContactRows<Real> pairs;                   ///< of two discs that move, a < b
    /// Contacts of a disc that moves and what nothing moves: walls, edges, immovable discs.
    ContactRows<Real> supports;

    /// Rows that padding names: each group has its own beyond the bodies, so that no two threads write to
    /// one.
    static std::size_t padding_rows(const TaskGroups& groups) {
        return groups.count() + groups.support_count();
    }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.renewals, self.version, self.trail, self.lost, self.former_places, self.groups,
                self.pairs, self.supports);
    }

  private:
    /// Contacts in the order of groups, before they are sorted by colour.
    struct Found {
        Column<std::int32_t> a, b;
        Column<std::uint8_t> colour;  // kColours: none was free
        Column<std::uint32_t> order;  // in which a group's contacts are coloured
        Column<Real> normal_impulse, friction_impulse;
        std::vector<std::size_t> begin;  // of each group, and the end

        void resize(std::size_t contacts) {
            a.resize_for_overwrite(contacts), b.resize_for_overwrite(contacts);
            colour.resize_for_overwrite(contacts), order.resize_for_overwrite(contacts);
            normal_impulse.resize_for_overwrite(contacts), friction_impulse.resize_for_overwrite(contacts);
        }
        std::size_t bytes() const {
            return a.bytes() + b.bytes() + colour.bytes() + order.bytes() + normal_impulse.bytes() +
                   friction_impulse.bytes();
        }
    };

    /// A contact of a last group, while that is laid out anew.
    struct Late {
        std::int32_t a, b;
        Real normal_impulse, friction_impulse, rolling_impulse;
        std::uint32_t colour;
    };

    void sort_former_places() {
        std::sort(former_places.begin(), former_places.end(),
                  [](const FormerPlace& left, const FormerPlace& right) { return left.row < right.row; });
    }
    void rename_rows(const Bodies<Real>& bodies);
    /// Notes what a body had from one that is gone.
    void lose_contact(const ContactRows<Real>& contacts, std::size_t i, std::int32_t gone, std::int32_t row,
                      const Bodies<Real>& bodies) {
        if (contacts.normal_impulse[i] > 0)
            lost.push_back(lost_contact<Real>(contacts, i, gone, row, former_places, bodies));
    }
    double far_share(const Candidates<Real>& candidates, const TaskGroups& tried) const;
    void choose_groups(const Candidates<Real>& candidates, std::size_t rows);
    bool is_forbidden(std::int32_t a, std::int32_t b) const {
        return filter && !filter->may_collide(static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    }
    void group_pairs(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                     const Executor& executor);
    template <class Pair>
    void for_each_piece(const Candidates<Real>& candidates, const Bodies<Real>& bodies,
                        const Executor& executor, const Pair& pair);
    void list_walls(const Candidates<Real>& candidates, const Bodies<Real>& bodies, const Walls& walls);
    void group_supports();
    void colour_pairs(std::size_t rows, const Executor& executor);
    void colour_supports(std::size_t rows);
    void colour_group(Found& found, std::size_t group, std::uint64_t* of_a, std::uint64_t* of_b);
    void sort_by_colour(const Found& found, ContactRows<Real>& sorted, std::size_t first_padding_row,
                        const Executor& executor);
    void add_late(ContactRows<Real>& sorted, std::int32_t padding_row, bool both_move);
    void lay_out_colours(const Found& found, ContactRows<Real>& sorted, std::size_t first_padding_row);

    Found found_pairs_, found_supports_;
    std::vector<std::int32_t> listed_a_, listed_b_;  // supports as they are found
    std::vector<Late> late_, new_pairs_, new_supports_;
    Crowds<Real> crowds_;
    bool has_discs_ = true;                     // that move: else no pair is one of discs
    std::vector<std::uint32_t> piece_counts_;   // by piece of the pair list and group
    Column<std::uint64_t> colours_of_[2];       // a row, bit a colour: inside or as a, as b of a border
    std::vector<std::uint32_t> colour_counts_;  // by group and colour
    std::vector<std::size_t> next_;             // place of each group's next contact without a colour
    ImpulseMemory<Real> memory_;
    RollingMemory<Real> rolling_of_pairs_, rolling_of_supports_;
};

extern template class ContactGraph<float>;
extern template class ContactGraph<double>;

}  // namespace carom

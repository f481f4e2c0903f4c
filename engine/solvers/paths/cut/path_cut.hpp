#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "kernels/paths/path_arguments.hpp"
#include "parallel/executor.hpp"

namespace carom {

/// A contact as the cut into paths sees it: a link between two bodies.
struct ContactLink {
    std::int32_t a, b;         ///< rows; kNothing where nothing moves the body. Not both of them
    float arm_a_x, arm_a_y;    ///< m, from the centre of mass of a to where the contact pushes
    float arm_b_x, arm_b_y;    ///< m, from that of b
    bool is_loaded;            ///< pushes at present
    bool is_watched = false;   ///< stands beside the paths
    bool is_in_turns = false;  ///< is solved more often than others

    static constexpr std::int32_t kNothing = -1;
};

/// Cuts the contacts of a world into paths that lead from body to body, and lays the paths out in bundles.
///
/// At each body those contacts are joined that face each other best, loaded ones first: a load goes straight
/// through. Every contact is in one path; a path names no body twice. Paths get colours, so that paths of one
/// colour share no body that moves; kPathLanes paths of a colour, about as long as each other, are a bundle.
/// Shorter paths stand behind those that end before their bundle does, after a link without a contact, so
/// that few places are empty. Paths of contacts that are solved more often are the first bundles of a colour.
/// What finds no colour among 64 shares others, round by round; beyond 1,024 it is alone in a bundle of a
/// colour of its own.
///
/// Contacts that are expected to carry nothing stand beside the paths, behind them: kPathLanes are a bundle
/// of one link, in no colour. Where contacts come and go, a cut is kept for some steps: those that come stand
/// beside it, those that go leave a link without a contact.
///
/// Cost: about 100 ns a contact, most of it on one thread. docs/decisions/0027-paths-of-contacts.md.
class PathCut {
  public:
    /// Colours that whole paths get, by preference; more are for what is left over.
    static constexpr int kColours = 8;
    static constexpr int kSlender = 8;

    /// Where a contact is.
    struct Place {
        std::uint32_t link;  ///< in the order of bundles: first_link()[bundle] + place in the path
        std::uint32_t bundle;
        std::uint8_t lane;
        bool is_reversed;  ///< the path goes from b to a
    };

    /// A place along a path, in the bundles of colours, that does not depend on the order of contacts.
    struct Slot {
        std::int32_t number;  ///< kPathLanes times the link, plus the lane; negative: none
        bool is_reversed;
        bool is_in_turns = false;  ///< as ContactLink has it; for contacts that stand beside the paths
    };

    /// A link without a contact before one that has one: it leads to where that begins.
    struct Jump {
        std::uint32_t link;
        std::uint8_t lane;
        std::int32_t contact;  ///< the first of the second path
    };

    /// @param rows  of bodies
    /// @param longest  contacts in a path, >= 1; those that are not slender have at most 64
    void cut(std::span<const ContactLink> contacts, std::size_t rows, std::size_t longest,
             const Executor& executor);

    /// Keeps the paths for contacts of which some are others than in `cut`, and in another order.
    /// @param slots  of contacts, as `slot_of` gave them; those without stand beside the paths
    /// Cost: about 3 ns a link and lane.
    void keep(std::span<const Slot> slots);
    Slot slot_of(std::size_t contact) const {
        const Place& place = places_[contact];
        if (place.bundle >= first_watched()) return {-1, false};
        return {static_cast<std::int32_t>(place.link * kPathLanes + place.lane), place.is_reversed};
    }

    /// The place of each contact, in the order of `cut` or `keep`.
    std::span<const Place> places() const { return places_; }
    std::size_t bundles() const { return first_link_.size() - 1; }
    std::size_t links() const { return first_link_.back(); }
    std::size_t colours() const { return first_bundle_.size() - 1; }
    /// Links of bundle i: first_link()[i] ... first_link()[i + 1].
    std::span<const std::size_t> first_link() const { return first_link_; }
    /// Bundles of colour c: first_bundle()[c] ... first_bundle()[c + 1].
    std::span<const std::size_t> first_bundle() const { return first_bundle_; }
    /// Bundles of colour c that are in turns: first_bundle()[c] ... end_of_turns()[c].
    std::span<const std::size_t> end_of_turns() const { return end_of_turns_; }
    /// The first bundle of contacts beside the paths.
    std::size_t first_watched() const { return first_bundle_.back(); }
    /// Behind the last of these that are in turns; they come first.
    std::size_t end_of_watched_turns() const { return end_of_watched_turns_; }
    /// The contacts beside the paths: those in turns, then the others, in their order.
    std::span<const std::uint32_t> watched() const { return watched_; }
    /// The contact in the first link of each lane of each bundle; -1: there is none.
    std::span<const std::int32_t> first_contacts() const { return first_contacts_; }
    std::span<const Jump> jumps() const { return jumps_; }
    /// A bundle has 1 if one of its paths is slender, as a tower is, else 0: no load leads to more than
    /// kSlender of its bodies but along it.
    std::span<const std::uint8_t> is_slender() const { return is_slender_; }
    std::size_t paths() const { return paths_; }
    /// Links of the longest bundle.
    std::size_t longest() const { return longest_; }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.places_, self.first_link_, self.first_bundle_, self.end_of_turns_, self.first_contacts_,
                self.jumps_, self.is_slender_, self.watched_, self.longest_, self.paths_, self.watched_turns_,
                self.end_of_watched_turns_);
    }

  private:
    struct Piece {
        std::uint32_t first, length;  // in sequence_
        std::uint32_t colour;
        bool is_in_turns = false;  // one of its contacts is
    };
    struct Step {
        std::int32_t contact;
        bool is_reversed;

        std::int32_t row_before(std::span<const ContactLink> contacts) const {
            const ContactLink& link = contacts[static_cast<std::size_t>(contact)];
            return is_reversed ? link.b : link.a;
        }
        std::int32_t row_after(std::span<const ContactLink> contacts) const {
            const ContactLink& link = contacts[static_cast<std::size_t>(contact)];
            return is_reversed ? link.a : link.b;
        }
    };

    void list_contacts_of_bodies(std::span<const ContactLink> contacts, std::size_t rows);
    void count_loads(std::span<const ContactLink> contacts, std::size_t rows);
    void split_broad(std::span<const ContactLink> contacts);
    void join_at(std::span<const ContactLink> contacts, std::int32_t row);
    void walk(std::span<const ContactLink> contacts, std::size_t rows, std::size_t longest);
    void walk_from(std::span<const ContactLink> contacts, std::size_t contact, std::size_t longest);
    void colour(std::span<const ContactLink> contacts, std::size_t rows);
    void colour_round(std::span<const ContactLink> contacts, std::uint32_t first_colour);
    template <class Fn>
    void for_each_row_of_pieces(std::span<const ContactLink> contacts, const Fn& fn) const;
    /// Whether one of some contacts of sequence_ is.
    bool is_in_turns(std::span<const ContactLink> contacts, std::uint32_t first, std::uint32_t last) const;
    void lay_out(std::span<const ContactLink> contacts);
    void lay_out_pieces(std::span<const ContactLink> contacts, std::size_t first, std::size_t last);
    template <class IsWatched, class IsInTurns>
    void list_watched(std::size_t contacts, const IsWatched& is_watched, const IsInTurns& is_in_turns);
    void lay_out_watched();
    void put(std::span<const ContactLink> contacts, const Piece& piece, std::uint8_t lane, std::size_t link);
    bool is_slender(std::span<const ContactLink> contacts, const Piece& piece) const;
    bool colours_share_no_body(std::span<const ContactLink> contacts, std::size_t rows) const;

    std::vector<std::uint32_t> first_at_;  // by row: its contacts, in contact_at_
    std::vector<std::uint32_t> contact_at_;
    std::vector<std::int32_t> joined_;         // [contacts][2]: the contact that follows at a, at b; -1
    std::vector<std::uint8_t> is_seen_;        // by contact
    std::vector<std::uint32_t> piece_of_row_;  // the last piece that came through a row
    std::vector<Step> sequence_;
    std::vector<Piece> pieces_, coloured_, left_;  // left_: what found no colour in a round
    std::vector<std::uint64_t> used_;              // by row: colours of a round
    std::vector<std::uint32_t> loaded_count_;      // by row: loaded contacts
    std::vector<std::uint32_t> order_, count_;
    std::vector<Place> places_;
    std::vector<std::size_t> first_link_{0}, first_bundle_{0}, end_of_turns_;
    std::vector<std::int32_t> first_contacts_;
    std::vector<Jump> jumps_;
    std::vector<std::uint8_t> is_slender_;
    std::vector<std::uint32_t> watched_, others_;  // contacts beside the paths; of those, not in turns
    std::vector<std::int32_t> contact_of_slot_;    // -1: none
    std::vector<std::uint32_t> bundle_of_link_;
    std::vector<std::size_t> next_of_length_,
        end_of_length_;              // in order_: pieces of a colour not laid out yet
    std::size_t watched_turns_ = 0;  // of watched_
    std::size_t end_of_watched_turns_ = 0;
    std::size_t longest_ = 0, paths_ = 0;
};

}  // namespace carom

#pragma once

#include <carom/vec2.hpp>

#include <cstdint>
#include <span>
#include <vector>

#include "sleeping/islands.hpp"
#include "solvers/contact_sets/contact_relaxation.hpp"
#include "solvers/contact_sets/local_contact.hpp"

namespace carom {

/// Few light bodies among much heavier ones, each group of them that touch each other by itself.
///
/// A grain in the gap between two balls touches both at nearly opposite normals: sweeps over its contacts
/// take hundreds of turns, though it has three numbers to be found. Relaxed for its velocity
/// (contact_relaxation.hpp) it is there at once, and the heavy bodies hardly notice. Groups that are not near
/// enough to the contact laws afterwards, as what heavy bodies squeeze between them, stay as they were.
/// docs/decisions/0106-grains-between-balls.md
/// kSize: numbers a body has, 3 with rotation, else 2.
template <int kSize>
class LightGroups {
  public:
    /// The contacts of a step are new, or their bodies.
    void begin_step() { are_known_ = false; }
    /// @param uneven  ratio of masses from which on the lighter of two bodies does not move the heavier
    /// @param records  [bodies][4], as the velocity records have them; out: likewise
    /// @param fall  m/s, what gravity adds in a substep; without it all is left
    /// Cost: O(contacts + bodies) a step, O(contacts of groups) times a few dozen at most.
    void solve(std::span<LocalContact> contacts, std::span<double> records, double uneven, double fall);
    /// What is left to be solved: places in the list of contacts; none if all groups are solved.
    std::span<const std::uint32_t> left() const { return left_; }
    /// How many contacts groups have that are not solved.
    std::size_t unsolved() const { return unsolved_; }

    std::size_t bytes() const;

  private:
    struct Group {
        std::uint32_t first, last;  // in order_
        bool has_pairs;             // if not: a heavy body and what does not move
        bool is_small;              // few light bodies
    };

    void find(std::span<const LocalContact> contacts, std::span<const double> records, double uneven);
    bool relax(const Group& group, std::span<LocalContact> contacts, std::span<double> records, double fall);
    double off() const;
    void give_impulses(double times);
    bool carries(double fall) const;
    Vec2 velocity_of_heaviest() const;
    double fastest(Vec2 from) const;

    bool are_known_ = false;
    Islands touching_;
    std::vector<std::uint32_t> order_;    // contacts, those of a group one behind the other
    std::vector<std::int32_t> group_of_;  // by contact: the smallest body of its group
    std::vector<std::int32_t> light_;     // by body: how many are in the group that it is the smallest of
    std::vector<Group> groups_;
    std::vector<std::uint32_t> left_;      // contacts
    std::size_t unsolved_ = 0;             // of these, what has pairs
    std::vector<std::int32_t> number_of_;  // by body: its number in a group; below zero: not in it
    std::vector<std::int32_t> bodies_;     // of a group
    std::vector<LocalContact> contacts_;   // likewise
    std::vector<double> records_;          // likewise
    ContactRelaxation<kSize> relaxation_;
};

extern template class LightGroups<2>;
extern template class LightGroups<3>;

}  // namespace carom

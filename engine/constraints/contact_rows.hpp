#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "constraints/partner.hpp"
#include "kernels/contacts/contact_arguments.hpp"
#include "shapes/edges.hpp"
#include "state/columns/column.hpp"

namespace carom {

/// The effects that ask for columns of contacts.
struct ContactEffects {
    bool friction = false, restitution = false, rolling = false;
    /// Whether contacts differ in it, so that one number does not serve all.
    bool friction_varies = false, rolling_varies = false, radius_varies = false;
    bool rolling_share_varies = false;  // where radii vary

    /// Supports have other materials and radii than bodies have, so they have all columns of an effect.
    ContactEffects of_supports() const {
        return {friction, restitution, rolling, friction, rolling, radius_varies, rolling};
    }
};

/// What a column of contacts is for: the one thing to state of a new one.
struct ColumnUse {
    enum class Of { pairs, supports, all } of;
    enum class Holds {
        from_step_to_step,   // part of the world's state, sized by ContactGraph
        until_pairs_change,  // described once; of supports, in each step
        in_a_step,
    } holds;
    /// Those of ContactEffects that must all be on; null: none.
    std::array<bool ContactEffects::*, 2> needs = {};

    bool is_needed(const ContactEffects& effects) const {
        for (const auto need : needs)
            if (need && !(effects.*need)) return false;
        return true;
    }
};

/// Contacts of one kind, by group (task_groups.hpp) and in each group by colour: no body that moves is in two
/// contacts of a colour, so all of a colour can be solved at once, by lanes, with the same bits. Each keeps
/// its impulses from step to step while its pair lives.
///
/// The contact graph has all that may come to touch until the broadphase finds pairs anew. Pairs are solved
/// where they stand there, and leave out blocks of which no contact can touch in a step. Supports are
/// solved in a second store, closer together: in a step few of them can touch.
template <class Real>
struct ContactRows {
    // Lengths are padded to kRowPadding.
    Column<std::int32_t> a;         // row
    Column<std::int32_t> b;         // Partner, as stored; of padding a row beyond the bodies
    Column<Real> normal_impulse;    // N s, of a substep
    Column<Real> friction_impulse;  // N s
    Column<Real> rolling_impulse;   // N s

    // What the kernels stream besides: kernels/contacts/contact_arguments.hpp.
    Column<Real> normal_x, normal_y, separation, mass, friction, floor;
    Column<Real> surface_normal, surface_tangent, rolling, rolling_share, surface_rolling;
    Column<Real> smaller;  // m
    // Once a step, or a step with restitution.
    Column<Real> reach;              // m, sum of the radii
    Column<std::int32_t> candidate;  // place in the contact graph
    Column<Real> approach;           // m/s, relative normal velocity at the start of the step
    Column<Real> clearance;  // m, separation at the start of the step, also where sweeps must not see it

    /// Every column of a number a contact: calls fn(column, use). Sizes, padding, moving and bytes follow.
    template <class Rows, class Fn>
    static void for_each_column(Rows& rows, const Fn& fn) {
        using E = ContactEffects;
        constexpr auto kAll = ColumnUse::Of::all, kPairs = ColumnUse::Of::pairs,
                       kSupports = ColumnUse::Of::supports;
        constexpr auto kLasts = ColumnUse::Holds::from_step_to_step,
                       kDescribed = ColumnUse::Holds::until_pairs_change, kStep = ColumnUse::Holds::in_a_step;
        fn(rows.a, ColumnUse{kAll, kLasts});
        fn(rows.b, ColumnUse{kPairs, kLasts});
        fn(rows.normal_impulse, ColumnUse{kAll, kLasts});
        fn(rows.friction_impulse, ColumnUse{kAll, kLasts, {&E::friction}});
        fn(rows.rolling_impulse, ColumnUse{kAll, kLasts, {&E::rolling}});
        fn(rows.normal_x, ColumnUse{kAll, kStep});
        fn(rows.normal_y, ColumnUse{kAll, kStep});
        fn(rows.separation, ColumnUse{kAll, kStep});
        fn(rows.mass, ColumnUse{kAll, kDescribed});
        fn(rows.friction, ColumnUse{kAll, kDescribed, {&E::friction, &E::friction_varies}});
        fn(rows.floor, ColumnUse{kAll, kStep});
        fn(rows.surface_normal, ColumnUse{kSupports, kStep});
        fn(rows.surface_tangent, ColumnUse{kSupports, kStep});
        fn(rows.rolling, ColumnUse{kAll, kDescribed, {&E::rolling, &E::rolling_varies}});
        fn(rows.rolling_share, ColumnUse{kAll, kDescribed, {&E::rolling, &E::rolling_share_varies}});
        fn(rows.surface_rolling, ColumnUse{kSupports, kStep, {&E::rolling}});
        fn(rows.smaller, ColumnUse{kAll, kDescribed, {&E::radius_varies}});
        fn(rows.reach, ColumnUse{kPairs, kDescribed});
        fn(rows.candidate, ColumnUse{kSupports, kStep});
        fn(rows.approach, ColumnUse{kAll, kStep, {&E::restitution}});
        fn(rows.clearance, ColumnUse{kSupports, kStep, {&E::restitution}});
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        for_each_column(self, [&](auto& column, const ColumnUse& use) {
            if (use.holds == ColumnUse::Holds::from_step_to_step) archive(column);
        });
        archive(self.begin, self.count, self.first_colour, self.has_overflow, self.overflow_stride);
    }

    /// Colour c is [begin[c], begin[c] + count[c]); begin[c] is a multiple of kRowPadding.
    std::vector<std::size_t> begin, count;
    /// Group g has the colours [first_colour[g], first_colour[g + 1]).
    std::vector<std::size_t> first_colour;
    /// The last colour of the last group takes what found no other: its contacts may share bodies and are
    /// solved one by one. They stand `overflow_stride` apart, with padding between.
    bool has_overflow = false;
    std::size_t overflow_stride = 1;

    /// Half blocks of contacts [first, last), whole blocks but for the last one, of which each has some that
    /// can touch.
    struct Run {
        std::uint32_t first, last;
    };
    // These columns are for pairs alone.
    Column<std::uint8_t> is_live;                    // a block: kernels/contacts/contact_arguments.hpp
    Column<std::uint8_t> is_struck;                  // a block: likewise
    Column<std::uint8_t> needs_second_sweep;         // a block: likewise
    Column<Run> run;                                 // those of a group begin at its first block
    std::vector<std::size_t> run_count, live_count;  // a group: runs, contacts that can touch

    /// N s; zero in worlds that have none.
    Real rolling_impulse_of(std::size_t contact) const {
        return contact < rolling_impulse.size() ? rolling_impulse[contact] : Real(0);
    }
    /// The other side of a contact of the graph.
    Partner partner(std::size_t contact) const { return Partner(b[contact]); }

    std::size_t colours() const { return begin.size(); }
    std::size_t groups() const { return first_colour.empty() ? 0 : first_colour.size() - 1; }
    std::size_t overflow() const { return has_overflow ? count.back() : 0; }
    std::size_t contacts() const;  // without padding
    std::size_t stride(std::size_t colour) const {
        return has_overflow && colour + 1 == colours() ? overflow_stride : 1;
    }
    /// Contacts the kernels run over in a colour. The rest of the last batch is padding.
    std::size_t length(std::size_t colour) const { return stride(colour) * count[colour]; }
    /// Where the contacts of a group begin; of the group after the last: where they end.
    std::size_t first_place(std::size_t group) const {
        return first_colour[group] < colours() ? begin[first_colour[group]] : a.size();
    }

    /// Calls fn(i) for every contact of the groups [first, last), or of all, that is no padding.
    template <class Fn>
    void for_each(std::size_t first, std::size_t last, const Fn& fn) const {
        for (std::size_t c = first_colour[first]; c < first_colour[last]; ++c)
            for (std::size_t n = 0, i = begin[c]; n < count[c]; ++n, i += stride(c)) fn(i);
    }
    template <class Fn>
    void for_each(const Fn& fn) const {
        if (groups() > 0) for_each(0, groups(), fn);
    }

    /// Room for the columns of a step beside those that last. What is described once is kept.
    void resize_for_step(const ContactEffects& effects);
    /// Room for what can touch in a step of `candidates`, to be closed up colour by colour. Supports alone.
    void resize_for_some_of(const ContactRows& candidates, const ContactEffects& effects);
    /// Closes colour number `colour`, whose contacts stand one behind the other from `first` on: fills
    /// its last batch with contacts of row `dummy` that push nothing. The overflow's contacts may share
    /// bodies, so each of them gets a batch of its own.
    /// @return the place of the next colour of the group.
    std::size_t close_colour(std::size_t colour, std::size_t first, std::size_t contacts, std::int32_t dummy);

    /// Whatever is no contact in the colours [first, last) names a padding row, and pushes nothing.
    void pad_colours(std::size_t first, std::size_t last, std::int32_t padding_row);
    /// As pad_colours in all groups, where contacts may have been taken out.
    /// @param first_padding_row  of the first group; the others' follow
    void pad_groups(std::size_t first_padding_row);
    /// Edges were removed; later ones moved up. Supports alone.
    void follow_removed_edges(EdgeStore::Removed gone);

    ContactColumns<Real> columns();
    std::size_t bytes() const;

  private:
    void pad(std::size_t first, std::size_t count, std::int32_t dummy);
    void pad_colour(std::size_t colour, std::size_t end, std::int32_t padding_row);
};

extern template struct ContactRows<float>;
extern template struct ContactRows<double>;

}  // namespace carom

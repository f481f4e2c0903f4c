#pragma once

#include <cstdint>
#include <vector>

#include "constraints/contact_candidates.hpp"
#include "kernels/contact_arguments.hpp"

namespace carom {

/// Contacts of one step as the kernels stream them, with what is used once beside them. Each group begins
/// where it does among the candidates, so that groups can be written side by side.
template <class Real>
struct ContactRows {
    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, separation, mass, normal_impulse, friction_impulse, friction, floor;
    Column<Real> largest_impulse, surface_normal, surface_tangent;
    Column<Real> reach;              // m, sum of the radii; only of pairs
    Column<std::int32_t> candidate;  // number among the candidates; only of supports
    Column<Real> approach;           // m/s, relative normal velocity at the start of the step
    Column<Real> bounce_impulse, bounce_friction, spare;
    Column<Real> rolling_impulse, rolling, rolling_share, surface_rolling, bounce_rolling;
    std::vector<std::size_t> begin, count;  // of each colour

    /// Blocks of kContactBlock contacts [first, last) of which each has some that can touch.
    struct Run {
        std::uint32_t first, last;
    };
    // Only of pairs.
    Column<std::uint8_t> is_live;                    // a block
    Column<std::uint8_t> needs_second_sweep;         // a block: kernels/contact_arguments.hpp
    Column<Run> run;                                 // those of a group begin at its first block
    std::vector<std::size_t> run_count, live_count;  // a group: runs, contacts that can touch
    std::vector<std::size_t> group_begin;            // place of each group, and the end
    std::size_t first_place(std::size_t group) const { return group_begin[group]; }

    /// Room for supports, which are compressed: candidates that cannot touch in this step are left out.
    void resize(const ContactCandidates<Real>& candidates, bool is_rough, bool bounces);
    /// Room for pairs, which stand where they stand among the candidates. What is described once, masses,
    /// reaches and coefficients, is kept.
    void resize_in_place(const ContactCandidates<Real>& candidates, bool friction_varies, bool bounces);
    /// The columns of rolling resistance; none of them without it. After the others. Keeps the same.
    void resize_rolling(std::size_t contacts, bool is_support, bool is_rolling, bool coefficient_varies,
                        bool radius_varies);
    /// Takes the columns that pairs share with their candidates, or gives them back.
    void swap_with(ContactCandidates<Real>& candidates);

    ContactColumns<Real> columns();
    std::size_t bytes() const;

    /// Closes colour number `colour`, whose contacts stand one behind the other from `first` on: fills
    /// its last batch with contacts of row `dummy` that push nothing. The overflow's contacts may share
    /// bodies, so each of them gets a batch of its own.
    /// @return the place of the next colour of the group.
    std::size_t close_colour(std::size_t colour, std::size_t first, std::size_t contacts, std::int32_t dummy);

    /// Contacts the kernels run over in a colour. The rest of the last batch is padding.
    std::size_t length(std::size_t colour) const {
        return is_serial(colour) ? kRowPadding * count[colour] : count[colour];
    }
    std::size_t contacts() const;
    std::size_t overflow() const { return has_overflow_ ? count.back() : 0; }

    /// Calls fn(contact) for every contact that is no padding, of all colours or of some.
    template <class Fn>
    void for_each(const Fn& fn) const {
        for_each(0, begin.size(), fn);
    }
    template <class Fn>
    void for_each(std::size_t first_colour, std::size_t last_colour, const Fn& fn) const {
        for (std::size_t c = first_colour; c < last_colour; ++c)
            for (std::size_t n = 0; n < count[c]; ++n) fn(begin[c] + n * (is_serial(c) ? kRowPadding : 1));
    }

  private:
    bool is_serial(std::size_t colour) const { return has_overflow_ && colour + 1 == count.size(); }
    void fit_bounces(std::size_t contacts, bool bounces, bool is_rough);
    void pad(std::size_t first, std::size_t count, std::int32_t dummy);

    bool has_overflow_ = false;
};

extern template struct ContactRows<float>;
extern template struct ContactRows<double>;

}  // namespace carom

#pragma once

#include <cstdint>
#include <vector>

#include "kernels/contact_arguments.hpp"
#include "solver/contact_candidates.hpp"

namespace carom {

/// Contacts of one step as the kernels stream them, with what is used once beside them. Each group begins
/// where it does among the candidates, so that groups can be written side by side.
template <class Real>
struct LiveContacts {
    Column<std::int32_t> a, b;
    Column<Real> normal_x, normal_y, separation, mass, normal_impulse, friction_impulse, friction, floor;
    Column<Real> largest_impulse, surface_normal, surface_tangent;
    Column<std::int32_t> candidate;  // number among the candidates
    Column<Real> approach;           // m/s, relative normal velocity at the start of the step
    Column<Real> bounce_impulse, bounce_friction, spare;
    Column<Real> rolling_impulse, rolling, rolling_share, surface_rolling, bounce_rolling;
    std::vector<std::size_t> begin, count;  // of each colour

    void resize(const ContactCandidates<Real>& candidates, bool is_support, bool is_rough,
                bool friction_varies, bool bounces);
    /// The columns of rolling resistance; none of them without it. After `resize`.
    void resize_rolling(bool is_rolling, bool coefficient_varies, bool radius_varies);
    ContactColumns<Real> columns();
    std::size_t bytes() const;

    /// Where the contacts of a group begin: where its candidates do. Behind them there is room.
    static std::size_t first_place(const ContactCandidates<Real>& candidates, std::size_t group) {
        const std::size_t colour = candidates.first_colour[group];
        return colour < candidates.colours() ? candidates.begin[colour] : candidates.a.size();
    }
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
    void pad(std::size_t first, std::size_t count, std::int32_t dummy);

    bool has_overflow_ = false;
};

extern template struct LiveContacts<float>;
extern template struct LiveContacts<double>;

}  // namespace carom

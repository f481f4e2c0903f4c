#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <tuple>

#include "constraints/contact_rows.hpp"
#include "math/vec2_math.hpp"
#include "state/bodies.hpp"

namespace carom {

/// A body pushed another one that was removed, or put elsewhere.
struct LostContact {
    std::int32_t gone, row;         // a number for what is not there any more; of what is
    bool is_impulse_known = false;  // not where edges were removed
    Vec2 impulse = {};              // N s, that `row` had from the other one in a substep
    double mass = 0;  // kg, of what is not there any more, infinite if nothing moved it; if known

    friend bool operator<(const LostContact& left, const LostContact& right) {
        return std::tie(left.gone, left.row) < std::tie(right.gone, right.row);
    }
};

/// Where a body was when it was removed or put elsewhere.
struct FormerPlace {
    std::int32_t row;  // that it had when the pairs were renewed
    Vec2 place;        // m
    double mass;       // kg, infinite if nothing moved it
};

/// What a body had from one that is gone.
/// @param i  number of their contact
/// @param row  of the body that is there, now
/// @param former_places  in the order of rows
template <class Real>
LostContact lost_contact(const ContactRows<Real>& contacts, std::size_t i, std::int32_t gone,
                         std::int32_t row, std::span<const FormerPlace> former_places,
                         const Bodies<Real>& bodies) {
    LostContact contact{gone, row};
    const auto former =
        std::lower_bound(former_places.begin(), former_places.end(), gone,
                         [](const FormerPlace& place, std::int32_t wanted) { return place.row < wanted; });
    if (former == former_places.end() || former->row != gone) return contact;
    const auto own = static_cast<std::size_t>(row);
    const Vec2 way = Vec2{bodies.position_x[own], bodies.position_y[own]} - former->place;
    const double distance = std::sqrt(length_squared(way));
    const double normal_impulse = contacts.normal_impulse[i];
    const double friction =
        contacts.friction_impulse.empty() ? 0 : static_cast<double>(contacts.friction_impulse[i]);
    // Towards `row`. The normal turns with the order of the bodies, and so does its tangent: on either body
    // the friction impulse is that along the tangent of the normal towards it.
    const Vec2 n = distance > 0 ? (1 / distance) * way : Vec2{};
    contact.impulse = normal_impulse * n + friction * Vec2{-n.y, n.x};
    contact.is_impulse_known = distance > 0;
    contact.mass = former->mass;
    return contact;
}

}  // namespace carom

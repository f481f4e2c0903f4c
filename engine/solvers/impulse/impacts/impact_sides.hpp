#pragma once

#include "effects/contact_law.hpp"
#include "solvers/impulse/impacts/flights.hpp"

// The two sides of an impact as the contact law takes them. For source files only: the law has internal
// linkage.

namespace carom {
namespace {

/// The law of impacts: friction, and some bodies that do not turn.
inline constexpr unsigned kImpacts = kRough | kFixedAngles;
using ImpactBody = MovingSide<kImpacts, DoubleLanes>;

ImpactBody body_of(const ContactRecord& r) {
    return {{{r.velocity_x, r.velocity_y, r.rim_speed, r.inverse_mass}}};
}
ContactRecord record_of(const ImpactBody& body) {
    return {body.record[0], body.record[1], body.record[2], body.record[3]};
}

/// Calls fn(a, b) for the sides of a meeting: of two bodies, or of a body and a wall at rest.
/// @param record_of_row  what a row is at the moment
template <class RecordOfRow, class Fn>
auto with_sides(Meeting m, const RecordOfRow& record_of_row, const Fn& fn) {
    ImpactBody a = body_of(record_of_row(m.a));
    if (m.with_wall()) {
        DoubleSurface wall{0, 0, 0};
        return fn(a, wall);
    }
    ImpactBody b = body_of(record_of_row(m.b));
    return fn(a, b);
}

}  // namespace
}  // namespace carom

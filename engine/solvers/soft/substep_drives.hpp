#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "solvers/paths/contact_work.hpp"
#include "solvers/soft/contacts/stored_contact.hpp"
#include "solvers/soft/solved_substep.hpp"

// What impulses of a substep did to bodies, and what may give these energy.

namespace carom {
namespace {

using Velocity = std::array<double, 3>;  // m/s: vx, vy, rim speed

template <class Real>
Velocity velocity_at(const Column<Real>& records, std::size_t row) {
    return {static_cast<double>(records[4 * row]), static_cast<double>(records[4 * row + 1]),
            static_cast<double>(records[4 * row + 2])};
}

/// The product a · M b of two velocities of a body of mass 1 [m²/s²]: its inertia is half the mass at the
/// rim.
double product(const Velocity& a, const Velocity& b) {
    return a[0] * b[0] + a[1] * b[1] + 0.5 * a[2] * b[2];
}

Velocity operator-(const Velocity& a, const Velocity& b) {
    return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

/// Whether impulses move what is in a row of the records.
template <class Real>
bool moves(const BodyRecords<Real>& records, std::int32_t row) {
    const auto r = static_cast<std::size_t>(row);
    return r < records.moving() && records.velocity[4 * r + 3] != 0;
}

/// Where there are none, the joints of the last step that had some are not to be looked at.
template <class Real>
bool has_joints(const SolvedSubstep<Real>& solved) {
    return !solved.step.world.joints.empty();
}

/// Whether what impulses do not move in a row moves by itself.
template <class Real>
bool drives(const Bodies<Real>& bodies, std::size_t row) {
    const std::uint8_t flags = bodies.flags_of(row);
    if ((flags & kKinematic) != 0) return true;
    return (flags & kImmovable) != 0 && (bodies.velocity_x[row] != 0 || bodies.velocity_y[row] != 0 ||
                                         (bodies.has_rotation && bodies.angular_velocity[row] != 0));
}

/// Calls fn(row, row, work, bend) for what may give energy in a substep: surfaces that move by themselves,
/// motors and springs; and what joints on paths that bend gave beyond those along straight ones. Works in J.
template <class Real, class Fn>
void for_each_drive(const SolvedSubstep<Real>& solved, const Fn& fn) {
    const BodyRecords<Real>& records = solved.contacts.records;
    const Bodies<Real>& bodies = solved.step.world.bodies;
    // A surface gives what its contact takes from it by the surface's own motion.
    const auto body = [&](std::int32_t row) {
        return moves(records, row) ? DoubleBody{} : body_at(records.velocity, row);
    };
    bool any_drives = false, any_disc_drives = false;
    for (std::size_t row = 0; row < bodies.count && bodies.has_flags; ++row) {
        if (!drives(bodies, row)) continue;
        any_drives = true;
        any_disc_drives =
            any_disc_drives || ((bodies.flags_of(row) & kKinematic) != 0 && bodies.is_disc(row));
    }
    const ContactRows<Real>& pairs = solved.contacts.graph.pairs;
    if (any_disc_drives)
        pairs.for_each([&](std::size_t i) {
            const std::int32_t a = pairs.a[i], b = pairs.b[i];
            if (pairs.is_live[i / kContactBlock] && moves(records, a) != moves(records, b))
                fn(a, b, -StoredContact<Real>(pairs, i).work(body(a), body(b)), 0.0);
        });
    // What stands gives nothing, and most scenes have nothing else that no impulse moves.
    const ContactRows<Real>& supports = solved.contacts.supports;
    if (any_drives)
        supports.for_each([&](std::size_t i) {
            fn(supports.a[i], supports.a[i],
               -StoredContact<Real>(supports, i).work(DoubleBody{}, surface_at(supports, i)), 0.0);
        });
    const auto motion = [&](std::int32_t row) {
        const DoubleBody of = body(row);
        return MeanVelocity{{of.record[0], of.record[1]}, of.record[2]};
    };
    if (any_drives && bodies.has_shapes) {
        solved.paths.for_each_unmoved([&](const PathContact<Real>& contact) {
            fn(contact.near, contact.far,
               -ContactWork<Real>(contact).work(motion(contact.near), motion(contact.far)), 0.0);
        });
        solved.paths.rolling().for_each_drive(
            records, [&](std::int32_t row, double work) { fn(row, row, work, 0.0); });
    }
    if (has_joints(solved)) solved.joints.for_each_drive(solved.step, fn);
}

}  // namespace
}  // namespace carom

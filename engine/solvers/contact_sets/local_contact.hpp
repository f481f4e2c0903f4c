#pragma once

#include <cmath>
#include <cstdint>
#include <span>

#include "effects/contact_law.hpp"
#include "kernels/contacts/contact_arguments.hpp"

namespace carom {

/// A contact of a system of bodies that is solved on its own, in double precision.
struct LocalContact {
    std::int32_t a, b;           // bodies of the system; b < 0: nothing moves it
    std::uint32_t contact;       // where it is stored
    ContactTerms<double> terms;  // friction and rolling are zero where there is none
    double surface_normal, surface_tangent, surface_rolling;  // m/s, of b where nothing moves it
    ContactImpulses<double> impulses;
    ContactImpulses<double> before;  // an iteration
    ContactImpulses<double> step;    // of the conjugate gradient

    /// Reads what is stored of the contact, all but the masses of its terms.
    template <class Real>
    void read(const SolveContacts<Real>& stored) {
        const ContactColumns<Real>& columns = stored.contacts;
        const auto value = [&](const Real* column, double without) {
            return column ? static_cast<double>(column[contact]) : without;
        };
        const bool is_rough = columns.friction_impulse != nullptr, rolls = columns.rolling_impulse != nullptr;
        impulses = {value(columns.normal_impulse, 0), value(columns.friction_impulse, 0),
                    value(columns.rolling_impulse, 0)};
        step = {};
        surface_normal = value(columns.surface_normal, 0);
        surface_tangent = value(columns.surface_tangent, 0);
        surface_rolling = value(columns.surface_rolling, 0);
        terms.nx = columns.normal_x[contact], terms.ny = columns.normal_y[contact];
        terms.floor = columns.floor[contact];
        terms.friction = is_rough ? value(columns.friction, static_cast<double>(stored.uniform_friction)) : 0;
        terms.rolling = rolls ? value(columns.rolling, static_cast<double>(stored.uniform_rolling)) : 0;
        terms.of_a = value(columns.rolling_share, 0.5);
    }
};

/// Calls fn(a, b) with the bodies of a contact, b a surface where nothing moves it, and keeps what that does
/// to their velocities.
/// @param records  [bodies][4], as the velocity records have them
template <class Fn>
void with_sides(double* records, const LocalContact& contact, const Fn& fn) {
    DoubleBody a{DoubleLanes::load_rows4(records, &contact.a)};
    if (contact.b < 0) {
        DoubleSurface surface{contact.surface_normal, contact.surface_tangent, contact.surface_rolling};
        fn(a, surface);
    } else {
        DoubleBody b{DoubleLanes::load_rows4(records, &contact.b)};
        fn(a, b);
        DoubleLanes::store_rows4(records, &contact.b, b.record);
    }
    DoubleLanes::store_rows4(records, &contact.a, a.record);
}

/// How far contacts are from their laws, each on its own: the largest change of a velocity that one asks for
/// [m/s].
/// @param body_of  gives the DoubleBody of a number
template <class BodyOf>
double largest_residual(std::span<const LocalContact> contacts, const BodyOf& body_of) {
    double largest = 0;
    for (const LocalContact& c : contacts) {
        const auto look_at = [&](DoubleBody a, auto b) {
            ContactImpulses<double> impulses = c.impulses;
            const ContactImpulses<double> added =
                solve_contact<kEveryEffect>(a, b, c.terms, impulses, [](double wanted) { return wanted; });
            const double change = std::fmax(std::fmax(std::fabs(added.normal), std::fabs(added.tangent)),
                                            std::fabs(added.rolling));
            largest = std::fmax(largest, change / c.terms.mass);
        };
        if (c.b < 0)
            look_at(body_of(c.a), DoubleSurface{c.surface_normal, c.surface_tangent, c.surface_rolling});
        else
            look_at(body_of(c.a), body_of(c.b));
    }
    return largest;
}

}  // namespace carom

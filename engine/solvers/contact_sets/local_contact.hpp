#pragma once

#include <cstdint>

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

}  // namespace carom

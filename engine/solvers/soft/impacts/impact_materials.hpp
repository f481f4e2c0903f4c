#pragma once

#include "constraints/contact_rows.hpp"
#include "effects/contact_law.hpp"
#include "effects/friction.hpp"
#include "effects/rolling_resistance.hpp"
#include "solvers/soft/contacts/contact_settings.hpp"
#include "state/columns/index.hpp"

// What decides the tangential and rolling impulses of an impact; zero where nothing turns.

namespace carom {

/// Those of a contact that the step knows. @param terms  out
template <class Real>
void materials_of_contact(const ContactRows<Real>& rows, std::size_t contact, const ContactSettings& settings,
                          ContactTerms<double>& terms) {
    terms.of_a = 0.5;
    if (!settings.effects.friction) return;
    const auto value = [&](const Column<Real>& column, double uniform) {
        return column.empty() ? uniform : static_cast<double>(column[contact]);
    };
    terms.friction = value(rows.friction, settings.friction);
    if (settings.effects.rolling) terms.rolling = value(rows.rolling, settings.rolling);
    terms.of_a = value(rows.rolling_share, 0.5);
}

/// Those of two bodies that are no contact. @param terms  out
template <class Real>
void materials_of_bodies(const Bodies<Real>& bodies, std::int32_t row_a, std::int32_t row_b,
                         const ContactSettings& settings, ContactTerms<double>& terms) {
    terms.of_a = 0.5;
    if (!settings.effects.friction) return;
    const std::size_t a = index(row_a), b = index(row_b);
    terms.friction = pair_friction(bodies.friction[a], bodies.friction[b]);
    if (settings.effects.rolling)
        terms.rolling = pair_rolling_resistance(bodies.rolling_resistance[a], bodies.rolling_resistance[b]);
    terms.of_a = rolling_share(bodies.radius[a], bodies.radius[b]);
}

}  // namespace carom

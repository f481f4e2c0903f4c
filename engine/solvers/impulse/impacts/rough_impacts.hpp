#pragma once

#include "solvers/impulse/impacts/flights.hpp"

// Impacts with friction. The contact law comes from effects/contact_law.hpp; in files of their own, so
// that impacts without friction need none of this.

namespace carom {

/// What two materials make of an impact.
struct ImpactCoefficients {
    double restitution, friction;
};

/// Carries out one impact at clock s: Newton's law of restitution along the normal, then surfaces stick, or
/// slide if that takes more than friction gives. Deflects and turns both bodies, and books the work as
/// restitution and as friction.
///     Jn = (1 + e) m_eff |vn|,   Jt = -vt m_eff / 3, but at most friction Jn   (both turn)
template <class Real>
void carry_out_rough(Flights<Real>& flights, Meeting m, const Encounter& e, const ImpactCoefficients& pair,
                     double s);

/// Applies impulses along the normal and the tangent at clock s; both bodies fly and turn on from there.
template <class Real>
void apply_impulses(Flights<Real>& flights, Meeting m, const Encounter& e, const ImpactImpulses& j, double s);

}  // namespace carom

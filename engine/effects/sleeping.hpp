#pragma once

#include <cmath>

// When a body is still, and which load a sleeping one does not feel. docs/decisions/0010-sleeping.md.

namespace carom {

/// An island sleeps when all its bodies have been still for so long [s].
inline constexpr double kTimeToSleep = 0.5;
/// But for no fewer steps: in long ones what has been thrown up is still for one or two at its highest.
inline constexpr double kFewestStepsToSleep = 12;
/// Without gravity nothing is pressed to rest: still is what would cross less than this share of its radius
/// in the time above.
inline constexpr double kStillShareOfRadius = 0.001;
/// A sleeping body is woken by what would give it this share of the speed below which it is still.
inline constexpr double kWakingShare = 0.1;

/// Speed, of the centre and of the rim, up to which a body is still [m/s]: what gravity adds in a substep.
/// Contacts at rest hold velocities no better than that. As substeps are so short that a body falls at most
/// 0.005 of the usual radius in one, g h²/2, it is at most 0.1 sqrt(g r): such a speed lifts nothing by
/// more than 0.005 r.
inline double still_speed(double gravity, double substep, double radius) {
    return gravity > 0 ? gravity * substep : kStillShareOfRadius * radius / kTimeToSleep;
}

}  // namespace carom

#pragma once

#include <cmath>

// Rolling resistance: surfaces that yield move the normal force N ahead of the point of contact by a lever
// arm, so that it turns against rolling. The arm is c R with the coefficient c of the pair and
//
//   R = ra rb / (ra + rb),   which is the disc's own radius on a plane,
//
// and the moment is at most c R N, as much as stops the rolling: Coulomb's law for spins. A disc rolls down a
// slope only if tan(slope) > c, and on a level floor without slip it slows down at (2/3) c g: with the
// friction force f, m a = -f and (m r²/2) a/r = f r - c m g r.
//
// In the rim speeds u = spin * radius the two bodies roll on each other at
//
//   w = R (spin_b - spin_a) = (1 - s) u_b - s u_a,   s = R / ra = rb / (ra + rb)
//
// and an impulse j [N s] along it, a moment impulse R j, changes the rim speeds by (1 - s) j rb²/Ib and
// -s j ra²/Ia. So no radius but the share s is needed, and j is at most c times the normal impulse.
//
// Source: the lever arm of Coulomb and Dupuit; model A of Ai, Chen, Rotter & Ooi, "Assessment of rolling
// resistance models in discrete element simulations", Powder Technology 206 (2011).

namespace carom {

/// A pair's coefficient: the larger of the two materials', for it is enough if one of them yields. For pairs
/// of rows solver `soft` computes it in the world's precision (solvers/soft/contacts/pair_finder.cpp).
inline double pair_rolling_resistance(double a, double b) {
    return std::fmax(a, b);
}

/// The share s above: the weight of body a's rim speed in the rolling velocity. For pairs of rows solver
/// `soft` computes it in the world's precision (solvers/soft/contacts/pair_finder.cpp).
constexpr double rolling_share(double radius_a, double radius_b) {
    return radius_b / (radius_a + radius_b);
}

}  // namespace carom

#pragma once

#include <cmath>

#include "math/exponential.hpp"
#include "math/rotation.hpp"

namespace carom {

/// How a spring's row acts in a substep: its impulse is -m (alpha C + gamma V), where m is the effective mass
/// of the row alone, C how far it is from rest at the start of the substep, and V the velocity of C over the
/// substep, C(end) = C + h V.
struct SpringTerms {
    double alpha = 0;  ///< 1/s
    double gamma = 0;  ///< no unit
};

inline constexpr double kTwoPi = 6.28318530717958647693;

/// Largest w h of a spring alone, of angular frequency w in a substep of h, that has the matched row.
inline constexpr double kStiffestAlone = 1;

/// The terms that are matched to the exact solution.
///
/// Let V be the velocity before. Then (1 + gamma) V' = V - alpha C and C' = C + h V', a linear map with the
/// determinant 1 / (1 + gamma) and the trace 1 + (1 - h alpha) / (1 + gamma). The exact flow of the damped
/// oscillator C'' + 2 z w C' + w² C = 0 over h has the determinant e^(-2 z w h) and the trace
/// 2 e^(-z w h) cos(w h sqrt(1 - z²)), with cosh for z > 1. Equal determinants and traces give equal
/// eigenvalues: frequency and damping do not depend on h. So
///
///     gamma = e^(2 z w h) - 1,   h alpha = (1 + gamma) (1 + determinant - trace).
///
/// Alone the row could take the exact solution itself; but rows that do so explode where springs couple (ten
/// masses in line at k h² / m = 0.17), and these do not. A spring too stiff for the step, w h > 1, gets the
/// implicit row: alpha = w² h, gamma = w² h² + 2 z w h, which no stiffness makes explode.
///
/// @param frequency  Hz  @param ratio  of the damping  @param h  s
/// @param least_gamma  for springs that meet with others: solvers/joints/spring_loads.hpp
/// docs/decisions/0026-joints.md has the measurements.
inline SpringTerms spring_terms(double frequency, double ratio, double h, double least_gamma) {
    const double wh = kTwoPi * frequency * h;
    if (wh > kStiffestAlone) return {wh * wh / h, wh * wh + 2 * ratio * wh};
    const double decay = exponential(-ratio * wh), determinant = decay * decay;
    double trace = 2 * decay;
    if (ratio < 1) {
        trace *= rotation_by(wh * std::sqrt(1 - ratio * ratio)).cos;
    } else {
        const double way = wh * std::sqrt(ratio * ratio - 1);
        trace = exponential(-ratio * wh + way) + exponential(-ratio * wh - way);
    }
    const double gamma = 1 / determinant - 1;
    return {(1 + gamma) * (1 + determinant - trace) / h, std::fmax(gamma, least_gamma)};
}

/// The half of such a row that comes before or after a step between whole ones, where steps begin and end
/// with velocities at whole times: two of them one after the other, at one place, do what one whole row does.
inline SpringTerms half_of(const SpringTerms& whole) {
    const double root = std::sqrt(1 + whole.gamma);
    return {whole.alpha / (1 + root), root - 1};
}

}  // namespace carom

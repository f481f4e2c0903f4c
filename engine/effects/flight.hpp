#pragma once

#include <cassert>

#include "math/vec2_math.hpp"

// Free flight under constant acceleration and linear drag, solved exactly.
//
// x'' = a - k x'   has   v(t) = v0 e^(-kt) + a s(t),   x(t) = x0 + v0 s(t) + a q(t)
// with              s(t) = (1 - e^(-kt)) / k,          q(t) = (t - s(t)) / k,
// and s = t, q = t²/2 without drag. Two bodies with the same acceleration move on straight lines relative to
// each other when time is measured by s: that makes the time of impact of a pair a quadratic, with or without
// drag and gravity. So s, not t, is the clock inside a step, and u = e^(-kt) = 1 - k s.
//
// The series use + - * / only, so every machine gives the same bits, and none of them cancels at small k t.

namespace carom {

/// A step is cut so that drag * substep stays below this; the series then reach round-off within
/// kSeriesTerms.
inline constexpr double kLargestDragTimesStep = 0.5;  // no unit
inline constexpr int kSeriesTerms = 24;               // .5^24 / 24! and .2^24: far below 2^-53

/// A moment of a flight: its time t and the clock s that goes with it, with drag and without.
struct FlightClock {
    double t = 0;     ///< s, since the start of the substep
    double s = 0;     ///< s
    double u = 1;     ///< e^(-kt), no unit
    double q = 0;     ///< s²
    double drag = 0;  ///< k, 1/s
};

/// q as a function of s. With z = k s:  q = s² (1/2 + z/3 + z²/4 + ...), from t = -ln(1 - z) / k.
inline double flight_q(double s, double drag) {
    if (drag == 0) return 0.5 * s * s;
    const double z = drag * s;
    double sum = 0;
    for (int n = 2 * kSeriesTerms; n >= 2; --n) sum = sum * z + 1.0 / n;
    return s * s * sum;
}

/// dq/ds = (s'-clock) t-rate: (1/(1 - k s) - 1) / k = s / (1 - k s).
inline double flight_q_slope(double s, double drag) {
    return s / (1 - drag * s);
}

/// The clock after time t.  s = t Σ (-kt)^n/(n+1)!,  q = t² Σ (-kt)^n/(n+2)!.
inline FlightClock flight_clock_at(double t, double drag) {
    assert(drag * t <= kLargestDragTimesStep);
    FlightClock clock{.t = t, .s = t, .u = 1, .q = 0.5 * t * t, .drag = drag};
    if (drag == 0) return clock;
    const double z = -drag * t;
    double s_sum = 0, q_sum = 0;
    for (int n = kSeriesTerms; n >= 0; --n) {
        s_sum = 1 + s_sum * z / (n + 2);
        q_sum = 1 + q_sum * z / (n + 3);
    }
    clock.s = t * s_sum;
    clock.u = 1 - drag * clock.s;
    clock.q = 0.5 * t * t * q_sum;
    return clock;
}

/// One body's flight in the coordinates above: where it would have been and moved at s = 0.
struct Flight {
    Vec2 position;      ///< x0, m
    Vec2 velocity;      ///< v0, m/s
    Vec2 acceleration;  ///< a, m/s²
};

inline Vec2 position_at(const Flight& f, double s, double q) {
    return f.position + s * f.velocity + q * f.acceleration;
}

inline Vec2 velocity_at(const Flight& f, double s, double drag) {
    return (1 - drag * s) * f.velocity + s * f.acceleration;
}

/// The flight that passes `position` with `velocity` at clock s, q.
inline Flight flight_through(Vec2 position, Vec2 velocity, Vec2 acceleration, double s, double q,
                             double drag) {
    const Vec2 v0 = (1 / (1 - drag * s)) * (velocity - s * acceleration);
    return {position - s * v0 - q * acceleration, v0, acceleration};
}

/// Energy a unit mass loses to drag on this flight from the start to clock s, q: k ∫ v² dt
/// = v0² k s (1 - k s/2) + v0·a k s² + a² (q - s²/2).
inline double drag_loss_per_mass(const Flight& f, double s, double q, double drag) {
    return length_squared(f.velocity) * (drag * s * (1 - 0.5 * drag * s)) +
           dot(f.velocity, f.acceleration) * (drag * s * s) +
           length_squared(f.acceleration) * (q - 0.5 * s * s);
}

}  // namespace carom

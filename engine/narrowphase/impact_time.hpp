#pragma once

#include <cmath>
#include <limits>

#include "effects/flight.hpp"
#include "narrowphase/time_of_impact.hpp"

// When do two discs in flight, or a disc and a wall, meet? Times are on the clock s of effects/flight.hpp.

namespace carom {

inline constexpr double kNever = std::numeric_limits<double>::infinity();
inline constexpr int kMostRootSteps = 64;  // each at least halves the distance; 6 are usual

/// The part of a substep in which an impact is looked for.
struct Window {
    double from;   ///< s
    double until;  ///< s
    double drag;   ///< 1/s
};

/// Relative approach that is not round-off, and that does not count as resting.
struct ApproachLimits {
    double touching = 0;  ///< m, separation up to which two surfaces count as in contact
    double resting = 0;   ///< m/s, a slower approach of touching surfaces is no impact
};

/// First time within the window at which the distance of two bodies in straight relative motion falls to
/// `reach`, or the window's start if they are already closer and approaching. Relative position at s: d + (s
/// - from) v.
inline double straight_impact_time(Vec2 d, Vec2 v, double reach, const Window& window) {
    const DiscApproach<double> discs(d.x, d.y, v.x, v.y, reach);
    if (!(discs.approach < 0)) return kNever;
    if (discs.gap <= 0) return window.from;
    const double discriminant = discs.discriminant();
    if (!(discriminant > 0)) return kNever;
    const double s = window.from + discs.time_of_impact(discriminant);
    return s <= window.until ? s : kNever;
}

/// The same when the two bodies' accelerations differ by a. Each step goes as far as is safe: the distance of
/// points in relative flight has a second derivative of at least -|a| q'', so the parabola with the
/// distance's present value, slope and that curvature lies below it, and its root before the impact.
/// Converges quadratically, from one side.
inline double accelerated_impact_time(const Flight& relative, double reach, const Window& window,
                                      double tolerance) {
    const double end_u = 1 - window.drag * window.until;
    const double curvature =
        std::sqrt(length_squared(relative.acceleration)) / (end_u * end_u);  // q'' <= 1/u²
    double s = window.from;
    for (int i = 0; i < kMostRootSteps; ++i) {
        const Vec2 d = position_at(relative, s, flight_q(s, window.drag));
        const Vec2 v = relative.velocity + flight_q_slope(s, window.drag) * relative.acceleration;
        const double distance = std::sqrt(length_squared(d));
        const double separation = distance - reach;
        const double slope = distance > 0 ? dot(d, v) / distance : 0;
        if (separation <= tolerance && slope < 0) return s;
        const double clear = separation > 0 ? separation : 0;
        if (!(curvature > 0) && slope >= 0) return kNever;
        const double root = std::sqrt(slope * slope + 2 * curvature * clear);
        // From contact and moving apart, the parabola returns after 2 slope / curvature; else the usual root.
        const double advance = slope > 0   ? (slope + root) / curvature
                               : clear > 0 ? 2 * clear / (root - slope)
                                           : 0;
        s += advance;
        if (s > window.until) return kNever;
        if (advance == 0) return slope < 0 ? s : kNever;
    }
    return s;
}

/// First time within the window at which a body's clearance to a wall, c + v s + a q(s), falls to zero. The
/// window's start if it is already there and approaching, or if it is inside and pulled back before it gets
/// out: the solver then sees a contact too gentle to bounce. Newton from the side on which it cannot
/// overshoot.
inline double wall_impact_time(double c, double v, double a, const Window& window) {
    const auto clearance = [&](double s) { return c + v * s + a * flight_q(s, window.drag); };
    const auto slope = [&](double s) { return v + a * flight_q_slope(s, window.drag); };
    const double now = clearance(window.from);
    if (now <= 0 && slope(window.from) < 0) return window.from;
    const bool falling_in =
        a <= 0;  // clearance is concave: it can only be missed by looking at the end alone
    if (falling_in) {
        if (clearance(window.until) > 0) return kNever;
        double s =
            window.until;  // right of the root, where a concave function's tangent does not overshoot it
        for (int i = 0; i < kMostRootSteps; ++i) {
            const double rate = slope(s);
            if (!(rate < 0)) return window.from;  // only where it starts at or below zero
            const double next = s - clearance(s) / rate;
            if (!(next < s) || next <= window.from) return next <= window.from ? window.from : s;
            s = next;
        }
        return s;
    }
    double s = window.from;  // convex: from the left the tangent stays below the function
    for (int i = 0; i < kMostRootSteps; ++i) {
        const double rate = slope(s);
        if (!(rate < 0)) return kNever;
        const double next = s - clearance(s) / rate;
        if (next > window.until) return kNever;
        if (!(next > s)) return s;
        s = next;
    }
    return s;
}

}  // namespace carom

#pragma once

#include "narrowphase/placed_convex.hpp"

namespace carom {

/// A convex shape that moves straight on and turns evenly.
struct MovingConvex {
    ConvexShape<double> shape;
    Vec2 centre, velocity;  // m, m/s
    double angle, spin;     // rad, rad/s
};

/// Where it is at a time [s].
PlacedConvex at_time(const MovingConvex& body, double time);

struct ConvexImpact {
    double time;      // s, up to which they are farther apart than half the target
    bool touches;     // false: they do not come as near as the target, and `time` is the end
    Vec2 normal;      // from a to b, at that time
    double distance;  // m, at that time
};

inline constexpr int kMostAdvances = 64;  // of one look: a few suffice unless both turn fast

/// The first time at which two convex shapes are no farther apart than `target`; 0 if they are not to begin
/// with. By conservative advancement (Mirtich 1996): each step is as long as it is safe by the present
/// normal, along which no point can be faster than both centres and the ends of both turning arms together,
/// and leads at most to half the target. So times only grow, and nothing passes through. After kMostAdvances
/// of them it says that they touch, wherever it has got to: they do not meet before.
/// @param dt      s, > 0
/// @param target  m, > 0
/// @param depth   m, how deep in each other they do not touch yet: all distances are larger by that
ConvexImpact impact_time(const MovingConvex& a, const MovingConvex& b, double dt, double target,
                         double depth = 0);

}  // namespace carom

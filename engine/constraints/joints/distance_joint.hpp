#pragma once

#include "constraints/joints/joint_rows.hpp"

namespace carom {

/// The distance of the anchors as the row along n tells it [m].
///
/// Where a path ends on the other side, p · n < 0, the distance says nothing of how far: there p · n counts,
/// or what draws two points together would draw them on with ever more force once they are through.
inline double distance_along(const JointArms& arms, Vec2 n) {
    const double along = dot(n, arms.between);
    return along > 0 ? std::sqrt(length_squared(arms.between)) : along;
}

/// A rod, a rope or a spring between two points.
///
/// The coordinate is the distance d = |p| of the anchors, p = x_b + r_b - x_a - r_a, less the length:
///
///     d' = p · p' / d = n · p',   n = p / d,   p' = v_b - v_a + spin_b × r_b - spin_a × r_a
///
/// so ja = r_a × n and jb = r_b × n. A rod holds it; a spring springs; a rope has stops alone, at d = min
/// and d = max.
inline void add_distance_rows(const StoredJoint& joint, const JointArms& arms, double until_end,
                              JointRows& rows) {
    const double length = std::sqrt(length_squared(arms.between));
    // Ends that meet have no direction: any is as good.
    const Vec2 n = length > 0 ? (1 / length) * arms.between : Vec2{1, 0};
    const double ja = cross(arms.a, n), jb = cross(arms.b, n);
    if (joint.is_held)
        rows.add(n, ja, jb, length - joint.length, joint.is_spring() ? RowLaw::spring : RowLaw::hold, 0);
    rows.add_stops(joint, n, ja, jb, length, until_end);
}

}  // namespace carom

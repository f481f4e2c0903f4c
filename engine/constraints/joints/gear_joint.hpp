#pragma once

#include "constraints/joints/prismatic_joint.hpp"

namespace carom {

/// The coordinate of a joint that a gear couples to another: the angle of a hinge or a wheel, the way of
/// a slider.
inline JointRow coordinate_of(const StoredJoint& joint, const JointPose& a, const JointPose& b) {
    const JointArms arms = arms_of(joint, a, b);
    if (joint.type != JointType::prismatic) return {{}, 1, 1, arms.angle, RowLaw::hold, 0};
    const AxisRow along(arms, rotate(a.turn, joint.axis));
    return {along.e, along.ja, along.jb, along.way, RowLaw::hold, 0};
}

/// The coordinate of a body that a gear couples by itself: its angle against the world, which is a.
inline JointRow coordinate_of_body(const JointPose& b) {
    return {{}, 1, 1, b.angle, RowLaw::hold, 0};
}

/// A gear: the second coordinate changes by `ratio` times what the first one does,
///
///     c = q2 - ratio q1 - (q2 - ratio q1 as the gear was made),   c' = q2' - ratio q1'
///
/// so its row is that of q2 less `ratio` times that of q1: over two bodies, or up to four where it couples
/// joints. An impulse of l along it turns what q2 turns by l, and what q1 turns by -ratio l.
inline double gear_value(const StoredJoint& gear, double first, double second) {
    return second - gear.ratio * first - gear.angle;
}

/// @param pose_of  JointPose of a BodyId
template <class PoseOf>
double gear_value(const JointStore& joints, const StoredJoint& gear, const PoseOf& pose_of) {
    const auto coordinate = [&](std::uint32_t slot, BodyId body) {
        if (slot == kNoJoint) return coordinate_of_body(pose_of(body)).value;
        return coordinate_of(joints[slot], pose_of(joints[slot].a), pose_of(joints[slot].b)).value;
    };
    return gear_value(gear, coordinate(gear.first, gear.a), coordinate(gear.second, gear.b));
}

}  // namespace carom

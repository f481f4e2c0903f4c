#pragma once

#include "constraints/joints/prismatic_joint.hpp"

namespace carom {

/// A wheel on a suspension: b's anchor is held on an axis of a, springs along it, and turns freely or by
/// a motor. The rows are those of a slider (AxisRow) and of an angle.
inline void add_wheel_rows(const StoredJoint& joint, const JointPose& a, const JointArms& arms,
                           JointRows& rows) {
    const Vec2 axis = rotate(a.turn, joint.axis);
    const AxisRow across(arms, {-axis.y, axis.x}), along(arms, axis);
    rows.add(across.e, across.ja, across.jb, across.way, RowLaw::hold, 0);
    rows.add(along.e, along.ja, along.jb, along.way, joint.is_spring() ? RowLaw::spring : RowLaw::hold, 1);
    add_drive(joint, {}, 1, 1, arms.angle, 0, rows);
}

}  // namespace carom

#pragma once

#include "constraints/joints/joint_rows.hpp"

namespace carom {

/// Two bodies as one: the rows of a hinge, and the angle held, or springing if the weld is soft.
inline void add_weld_rows(const StoredJoint& joint, const JointArms& arms, JointRows& rows) {
    rows.add({1, 0}, -arms.a.y, -arms.b.y, arms.between.x, RowLaw::hold, 0);
    rows.add({0, 1}, arms.a.x, arms.b.x, arms.between.y, RowLaw::hold, 1);
    rows.add({}, 1, 1, arms.angle, joint.is_spring() ? RowLaw::spring : RowLaw::hold, 2);
}

}  // namespace carom

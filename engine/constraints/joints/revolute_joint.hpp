#pragma once

#include "constraints/joints/joint_rows.hpp"

namespace carom {

/// A hinge: two points stay on each other.
///
/// The coordinates are those of p = x_b + r_b - x_a - r_a; as (spin × r)_x = -spin r_y and
/// (spin × r)_y = spin r_x, the x row has ja = -r_a.y, jb = -r_b.y and the y row ja = r_a.x, jb = r_b.x.
/// Spring, motor and limits act on the angle of b against a, whose row has no direction and ja = jb = 1.
inline void add_revolute_rows(const StoredJoint& joint, const JointArms& arms, double until_end,
                              JointRows& rows) {
    rows.add({1, 0}, -arms.a.y, -arms.b.y, arms.between.x, RowLaw::hold, 0);
    rows.add({0, 1}, arms.a.x, arms.b.x, arms.between.y, RowLaw::hold, 1);
    if (joint.is_spring()) rows.add({}, 1, 1, arms.angle, RowLaw::spring, 2);
    add_drive(joint, {}, 1, 1, arms.angle, until_end, rows);
}

}  // namespace carom

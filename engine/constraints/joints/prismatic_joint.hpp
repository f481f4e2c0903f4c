#pragma once

#include "constraints/joints/joint_rows.hpp"

namespace carom {

/// The row of p · e, where p goes from a's anchor to b's and e is a direction that turns with a:
///
///     (p · e)' = e · (v_b - v_a) + spin_b (r_b × e) - spin_a (r_a × e) + spin_a (e × p)
///
/// as e' = spin_a × e, and e × p = -p × e: so ja = (r_a + p) × e and jb = r_b × e.
struct AxisRow {
    Vec2 e;
    double ja, jb, way;

    AxisRow(const JointArms& arms, Vec2 direction)
        : e(direction),
          ja(cross(arms.a + arms.between, direction)),
          jb(cross(arms.b, direction)),
          way(dot(arms.between, direction)) {}
};

/// A slider: b moves along an axis of a and does not turn against it. The way across the axis and the angle
/// are held; spring, motor and limits act on the way along it.
inline void add_prismatic_rows(const StoredJoint& joint, const JointPose& a, const JointArms& arms,
                               double until_end, JointRows& rows) {
    const Vec2 axis = rotate(a.turn, joint.axis);
    const AxisRow across(arms, {-axis.y, axis.x}), along(arms, axis);
    rows.add(across.e, across.ja, across.jb, across.way, RowLaw::hold, 0);
    rows.add({}, 1, 1, arms.angle, RowLaw::hold, 1);
    if (joint.is_spring()) rows.add(along.e, along.ja, along.jb, along.way, RowLaw::spring, 2);
    add_drive(joint, along.e, along.ja, along.jb, along.way, until_end, rows);
}

}  // namespace carom

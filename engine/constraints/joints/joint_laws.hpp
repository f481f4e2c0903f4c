#pragma once

#include "constraints/joints/distance_joint.hpp"
#include "constraints/joints/gear_joint.hpp"
#include "constraints/joints/prismatic_joint.hpp"
#include "constraints/joints/revolute_joint.hpp"
#include "constraints/joints/target_joint.hpp"
#include "constraints/joints/weld_joint.hpp"
#include "constraints/joints/wheel_joint.hpp"

namespace carom {

/// The rows of a joint of any kind; a target has none, and that of a gear takes more than two bodies.
/// @param until_end  s, to the end of the step: limits may move until then
inline JointRows rows_of(const StoredJoint& joint, const JointPose& a, const JointPose& b,
                         double until_end = 0) {
    const JointArms arms = arms_of(joint, a, b);
    JointRows rows;
    switch (joint.type) {
        case JointType::distance:
            add_distance_rows(joint, arms, until_end, rows);
            break;
        case JointType::revolute:
            add_revolute_rows(joint, arms, until_end, rows);
            break;
        case JointType::prismatic:
            add_prismatic_rows(joint, a, arms, until_end, rows);
            break;
        case JointType::weld:
            add_weld_rows(joint, arms, rows);
            break;
        case JointType::wheel:
            add_wheel_rows(joint, a, arms, rows);
            break;
        case JointType::target:
        case JointType::gear:
            break;
    }
    return rows;
}

/// The values of the firm rows alone, in their order, elsewhere: quicker for the kinds that most systems
/// consist of. @param from  the rows where the path began
inline void values_of(const StoredJoint& joint, const JointPose& a, const JointPose& b, const JointRows& from,
                      std::array<double, 3>& values) {
    if (from.firm == 0) return;
    if (joint.type == JointType::revolute || joint.type == JointType::distance ||
        joint.type == JointType::weld) {
        const JointArms arms = arms_of(joint, a, b);
        if (joint.type == JointType::distance)
            values[0] = distance_along(arms, from.row[0].n) - joint.length;
        else
            values = {arms.between.x, arms.between.y, arms.angle};
        return;
    }
    const JointRows rows = rows_of(joint, a, b);
    for (std::size_t k = 0; k < static_cast<std::size_t>(from.firm); ++k) values[k] = rows.row[k].value;
}

/// The value of a limit's row elsewhere. @param number  of the row among those where the path began
inline double value_of_stop(const StoredJoint& joint, const JointPose& a, const JointPose& b,
                            double until_end, const JointRows& from, int number) {
    const auto i = static_cast<std::size_t>(number);
    if (joint.type != JointType::distance) return rows_of(joint, a, b, until_end).row[i].value;
    const JointArms arms = arms_of(joint, a, b);
    const bool is_upper = joint.has_upper && number == from.count - 1;  // the last row, of the other sign
    return is_upper ? joint.upper.before_end(until_end) - distance_along(arms, -from.row[i].n)
                    : distance_along(arms, from.row[i].n) - joint.lower.before_end(until_end);
}

}  // namespace carom

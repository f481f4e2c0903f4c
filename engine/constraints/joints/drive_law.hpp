#pragma once

#include <cstddef>

#include "state/joints.hpp"

namespace carom {

/// What acts on the one coordinate of a joint that gives way: the length of a distance joint, the way along
/// an axis, or the angle.
struct DriveLaw {
    bool is_held = false;  ///< it is none: it stays where it is
    bool springs = false;  ///< to its rest
    bool has_motor = false;
    bool has_ends = false;
    std::size_t slot = 2;  ///< of StoredJoint::impulse, what all of it gave

    bool acts() const { return is_held || springs || has_motor || has_ends; }
};

/// The law of a joint's angle.
inline DriveLaw law_of_angle(const StoredJoint& joint) {
    const bool has_ends = joint.has_lower || joint.has_upper;
    switch (joint.type) {
        case JointType::revolute:
            return {.springs = joint.is_spring(), .has_motor = joint.has_motor, .has_ends = has_ends};
        case JointType::weld:
            return {.is_held = !joint.is_spring(), .springs = joint.is_spring()};
        case JointType::prismatic:
            return {.is_held = true, .slot = 1};
        case JointType::wheel:
            return {.has_motor = joint.has_motor};
        case JointType::distance:
        case JointType::target:
        case JointType::gear:
            break;
    }
    return {};
}

/// The law of a distance joint's length, or of the way along the axis of a slider or a wheel.
inline DriveLaw law_of_way(const StoredJoint& joint) {
    const bool has_ends = joint.has_lower || joint.has_upper;
    switch (joint.type) {
        case JointType::distance:
            return {.springs = joint.is_spring(), .has_ends = has_ends, .slot = 0};
        case JointType::prismatic:
            return {.springs = joint.is_spring(), .has_motor = joint.has_motor, .has_ends = has_ends};
        case JointType::wheel:
            return {.is_held = !joint.is_spring(), .springs = joint.is_spring(), .slot = 1};
        case JointType::revolute:
        case JointType::weld:
        case JointType::target:
        case JointType::gear:
            break;
    }
    return {};
}

}  // namespace carom

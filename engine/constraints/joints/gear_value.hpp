#pragma once

#include "constraints/joints/joint_laws.hpp"
#include "constraints/joints/joint_system.hpp"

// Inside of joint_system.cpp and joint_paths.cpp: how far a gear is from what it holds.

namespace carom {

/// @param pose_of  JointPose of a body by its number
template <class PoseOf>
double JointSystem::value_of_gear(const Gear& gear, const PoseOf& pose_of) const {
    const auto value = [&](const Coordinate& of) {
        if (of.joint < 0) return coordinate_of_body(pose_of(of.b)).value;
        return coordinate_of(*joints[static_cast<std::size_t>(of.joint)].joint, pose_of(of.a), pose_of(of.b))
            .value;
    };
    return gear_value(*joints[static_cast<std::size_t>(gear.joint)].joint, value(gear.coordinates[0]),
                      value(gear.coordinates[1]));
}

}  // namespace carom

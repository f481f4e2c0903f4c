#pragma once

#include <carom/ids.hpp>
#include <carom/vec2.hpp>

#include <span>

namespace carom {

/// A body has come into a sensor, or has left it. Where one of the two was removed meanwhile, its handle is
/// the one it had.
struct SensorEvent {
    BodyId sensor, body;
    bool begins = true;  ///< false: it has left
    double time = 0;     ///< s, end of the step
    Vec2 position{};     ///< m, of the body then; where it was removed, of the origin
};

/// A joint that was removed because its force or torque passed `Joint::break_force` or `break_torque`.
struct JointBreak {
    JointId joint{};    ///< the handle that it had
    BodyId a{}, b{};    ///< its bodies; BodyId{}: the world
    double time = 0;    ///< s, the end of the step in which it broke
    Vec2 point{};       ///< m, where it held b, at that time
    Vec2 force{};       ///< N, mean force on b in that step
    double torque = 0;  ///< N m, mean torque on b in that step, about the point
};

/// What happened, by kind, in the order in which it happened; within a step by handle: of the sensor, then of
/// the body; of the joint.
struct Events {
    std::span<const SensorEvent> sensor;
    std::span<const JointBreak> breaks;
};

}  // namespace carom

#pragma once

#include <carom/ids.hpp>
#include <carom/vec2.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <variant>

namespace carom {

// The kinds of joints. Anchors of `DistanceJoint` and `TargetJoint` are in the frames of their bodies, from
// the centre, or points of the world where there is no body. All other anchors and axes are points and
// directions of the world at the moment at which the joint is made: where bodies stand then is what the joint
// keeps. A spring has a frequency > 0: that of the two bodies on it alone, whatever the step length.

/// Keeps two points at a distance: a rod. With `min` or `max` a rope, which pulls at its ends alone; with
/// a frequency a spring of rest length `length`.
struct DistanceJoint {
    Vec2 anchor_a{};                 ///< m
    Vec2 anchor_b{};                 ///< m
    std::optional<double> length{};  ///< m, > 0; left out: the distance now
    std::optional<double> min{};     ///< m, >= 0: the points come no nearer
    std::optional<double> max{};     ///< m, >= min: they go no farther apart
    double frequency = 0;            ///< Hz, >= 0; 0: rigid
    double damping_ratio = 0;        ///< 1: critical; >= 0
};

/// Keeps a point of one body on a point of the other: a hinge.
struct RevoluteJoint {
    std::optional<Vec2> anchor{};   ///< m; left out: the centre of b
    std::optional<double> lower{};  ///< rad, least angle of b against a, 0 where they stand when it is made
    std::optional<double> upper{};  ///< rad, >= lower
    std::optional<double> motor_speed{};  ///< rad/s, of b against a
    double max_motor_torque = 0;          ///< N m, >= 0
    double frequency = 0;                 ///< Hz, of a spring towards angle 0
    double damping_ratio = 0;
};

/// Lets b slide on an axis of a, without turning against it: a slider.
struct PrismaticJoint {
    Vec2 axis{1, 0};                      ///< direction, of any length but 0
    std::optional<Vec2> anchor{};         ///< m, on the axis; left out: the centre of b
    std::optional<double> lower{};        ///< m, least way of b along the axis, 0 where it stands when made
    std::optional<double> upper{};        ///< m, >= lower
    std::optional<double> motor_speed{};  ///< m/s
    double max_motor_force = 0;           ///< N, >= 0
    double frequency = 0;                 ///< Hz, of a spring towards way 0
    double damping_ratio = 0;
};

/// Holds b to a as if they were one body; with a frequency it bends, at `anchor`.
struct WeldJoint {
    std::optional<Vec2> anchor{};  ///< m; left out: the centre of b
    double frequency = 0;          ///< Hz, of the angle; 0: rigid
    double damping_ratio = 0;
};

/// A wheel b on a body a: b turns about `anchor` and moves along `axis` on a spring, the suspension.
struct WheelJoint {
    std::optional<Vec2> anchor{};         ///< m; left out: the centre of b
    Vec2 axis{0, 1};                      ///< direction, of any length but 0
    double frequency = 0;                 ///< Hz, of the suspension; 0: the axis is held
    double damping_ratio = 0;             ///< of the suspension
    std::optional<double> motor_speed{};  ///< rad/s, of b against a
    double max_motor_torque = 0;          ///< N m, >= 0
};

/// Draws a point of b to a point of the world with a force that has a limit, as a mouse does.
struct TargetJoint {
    Vec2 anchor{};             ///< m, in b's frame
    Vec2 target{};             ///< m
    double max_force = 0;      ///< N, > 0
    double frequency = 5;      ///< Hz, > 0
    double damping_ratio = 1;  ///< >= 0
};

/// Couples what two joints leave free: the second coordinate changes by `ratio` times what the first one
/// does. The coordinate of a revolute or wheel joint is its angle [rad], that of a prismatic joint its way
/// [m]; both joints have a body b. Without joints the coordinates are the angles of the gear's own bodies a
/// and b. A gear goes with either of its joints.
struct GearJoint {
    std::optional<JointId> first{};   ///< left out: the angle of a
    std::optional<JointId> second{};  ///< left out: the angle of b; either both are given or none is
    double ratio = 1;                 ///< second over first, not 0; below zero: the other way round
};

using JointKind =
    std::variant<DistanceJoint, RevoluteJoint, PrismaticJoint, WeldJoint, WheelJoint, TargetJoint, GearJoint>;

/// What holds two bodies together, or a body to the world. Needs solver `soft` or `rattle`.
struct Joint {
    std::optional<BodyId> a{};  ///< left out: the world
    std::optional<BodyId> b{};  ///< left out: the world; one of the two is a body that moves
    JointKind kind = RevoluteJoint{};
    bool collide = false;  ///< whether the two bodies may touch
    /// N, N m: beyond one of them in a step the joint breaks: it is removed.
    double break_force = std::numeric_limits<double>::infinity();
    double break_torque = std::numeric_limits<double>::infinity();
};

/// How far the joints of a world are from what they hold [m]: gaps at anchors, lengths of rods, ways across
/// an axis, angles of welds and sliders times the distance of the centres.
struct JointErrors {
    std::int64_t joints = 0;
    double mean = 0;  ///< m
    double max = 0;   ///< m
};

/// Limits of what a joint may hold.
inline constexpr double kLargestFrequency = 1e6;     // Hz
inline constexpr double kLargestDampingRatio = 1e3;  // no unit
inline constexpr double kShortestRod = 1e-9;         // m
inline constexpr double kLargestGearRatio = 1e6;     // and its inverse the smallest

}  // namespace carom

#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "math/rotation.hpp"
#include "math/vec2_math.hpp"
#include "state/joints.hpp"

// A joint as rows of a linear system, in double precision. Each kind has a file of its own with its
// derivation; here is what they have in common.
//
// A row holds, springs, drives or limits one coordinate c of the two bodies: its velocity is
//
//     c' = n · (v_b - v_a) + jb spin_b - ja spin_a
//
// and an impulse along it gives b the impulse n and the angular impulse jb, a those of the other sign.

namespace carom {

/// Where a body is: what rows depend on.
struct JointPose {
    Vec2 position;     // m, of the centre of mass
    Rotation turn;     // of its frame
    double angle = 0;  // rad, of that turn, whole turns counted
};

/// The turn by a small angle in a substep, or by any.
inline Rotation turn_by(double angle) {
    if (angle > 0.5 || angle < -0.5) return rotation_by(angle);
    const double q = angle * angle;  // 0.5^14 / 14! is below 2^-50
    return {1 - q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90 * (1 - q / 132))))),
            angle * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156))))))};
}

inline Rotation after(const Rotation& first, const Rotation& then) {
    return {then.cos * first.cos - then.sin * first.sin, then.sin * first.cos + then.cos * first.sin};
}

inline void turn_pose(JointPose& pose, double angle) {
    pose.turn = after(pose.turn, turn_by(angle));
    pose.angle += angle;
}

enum class RowLaw : std::uint8_t {
    hold,    ///< the coordinate stays 0
    spring,  ///< it springs to 0: constraints/joints/spring_law.hpp
    motor,   ///< its velocity is `motor_speed`, if `max_motor` suffices
    stop,    ///< it stays above 0: the row of a limit, which points away from it
};

struct JointRow {
    Vec2 n;         // no unit, length 1, or 0 for the row of an angle
    double ja, jb;  // m, or 1 for the row of an angle
    double value;   // m or rad
    RowLaw law;
    std::uint8_t slot;  // of StoredJoint::impulse; of a stop: none, kNoSlot
    double rate = 0;    // m/s or rad/s, of `value` while the bodies rest: of a stop whose limit moves
};
inline constexpr std::uint8_t kNoSlot = 3;  // behind the three of StoredJoint::impulse

/// Rows that hold or spring come first.
struct JointRows {
    static constexpr int kMost = 6;  // two that hold, a spring, a motor, two stops
    int count = 0;
    int firm = 0;  // rows that hold or spring
    std::array<JointRow, kMost> row;

    void add(Vec2 n, double ja, double jb, double value, RowLaw law, std::uint8_t slot) {
        if (law == RowLaw::hold || law == RowLaw::spring) ++firm;
        row[static_cast<std::size_t>(count++)] = {n, ja, jb, value, law, slot};
    }
    /// The stops of a coordinate whose row is given.
    /// @param until_end  s, to the end of the step: limits may move until then
    void add_stops(const StoredJoint& joint, Vec2 n, double ja, double jb, double value, double until_end) {
        if (joint.has_lower) {
            add(n, ja, jb, value - joint.lower.before_end(until_end), RowLaw::stop, kNoSlot);
            row[static_cast<std::size_t>(count - 1)].rate = -joint.lower.rate;
        }
        if (joint.has_upper) {
            add(-n, -ja, -jb, joint.upper.before_end(until_end) - value, RowLaw::stop, kNoSlot);
            row[static_cast<std::size_t>(count - 1)].rate = joint.upper.rate;
        }
    }
};

/// Where the anchors of a joint are.
struct JointArms {
    Vec2 a, b;     // m, from the centres to the anchors
    Vec2 between;  // m, from a's anchor to b's
    double angle;  // rad, of b against a, 0 as the joint was made
};

inline JointArms arms_of(const StoredJoint& joint, const JointPose& a, const JointPose& b) {
    JointArms arms;
    arms.a = rotate(a.turn, joint.anchor_a), arms.b = rotate(b.turn, joint.anchor_b);
    arms.between = (b.position - a.position) + (arms.b - arms.a);
    arms.angle = b.angle - a.angle - joint.angle;
    return arms;
}

/// Motor, then limits, of a coordinate whose row is given.
inline void add_drive(const StoredJoint& joint, Vec2 n, double ja, double jb, double value, double until_end,
                      JointRows& rows) {
    if (joint.has_motor) rows.add(n, ja, jb, value, RowLaw::motor, kNoSlot);
    rows.add_stops(joint, n, ja, jb, value, until_end);
}

}  // namespace carom

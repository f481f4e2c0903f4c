#pragma once

#include <cstddef>
#include <cstdint>

// Plain arguments of the kernels that sweep over joints (solver `soft`): rods between centres, rods between
// anchors, hinges; springs and ropes; limits, motors and springs of angles. Columns are padded and 64-byte
// aligned; `first` and `last` are multiples of kRowPadding. Records of bodies are those of
// contact_arguments.hpp; the world is a row beyond the bodies, at rest.

namespace carom {

/// Places of joints that share what is known of how their rows lie. It is kRowPadding, which kernels do not
/// see.
inline constexpr std::size_t kJointBlock = 16;

/// Turn in a substep up to which arms and rods bend as they do [rad].
inline constexpr double kMostBend = 0.3;

/// How the rows of a block of joints lie: any; or of each four joints rows a are consecutive, and so are rows
/// b; or a, b, a, b, a, b, a, b are.
enum class RowOrder : std::uint8_t { any, runs, pairs };

/// Joints of one kind, sorted by group and colour: a body that moves is in one joint of a colour.
template <class Real>
struct JointColumns {
    std::int32_t* a;        // row
    std::int32_t* b;        // row
    const RowOrder* order;  // of each kJointBlock places
    Real* start_x;          // m, from a's centre to b's at the start of the step
    Real* start_y;          //
    Real* length;           // m; of rods
    Real* impulse_x;        // N s, of a substep: along the normal; of hinges along x
    Real* impulse_y;        // N s, along y; of hinges
    Real* normal_x;         // no unit, in the last substep; of rods
    Real* normal_y;         //
    Real* per_length;       // 1/m, of the distance now; of rods
    // Only where anchors are not the centres.
    Real *start_arm_a_x, *start_arm_a_y;  // m, at the start of the step
    Real *start_arm_b_x, *start_arm_b_y;  //
    Real *arm_a_x, *arm_a_y;              // m, in the last substep
    Real *arm_b_x, *arm_b_y;              //
    Real *per_rim_a, *per_rim_b;          // 1/m, of the rims of the bodies
    Real *seen_a, *seen_b;                // no unit, inertia over that which a substep sees; 1: as it is
    // Only where something springs, drives or has ends: lengths [m] or angles [rad], impulses in N s or N m
    // s. Of these joints impulse_x is that of the spring, impulse_y of the motor; start_x of angles is the
    // angle.
    Real *impulse_z, *impulse_w;    // of the lower and of the upper end
    Real* value;                    // the length or angle in this substep
    Real *alpha, *gamma;            // 1/s, no unit: constraints/joints/spring_law.hpp; 0, 0: no spring
    Real *lower, *upper;            // at the end of the step; beyond all numbers where there is no end
    Real *lower_rate, *upper_rate;  // m/s or rad/s, where ends move
    Real *speed, *most;             // m/s or rad/s; N s or N m s in a substep, 0 where there is no motor
};

/// One Gauss-Seidel sweep over joints of a kind.
template <class Real>
struct SweepJoints {
    JointColumns<Real> joints;
    Real* velocity;      // [rows][4]
    Real* displacement;  // [rows][2]
    Real* turn;          // m, at the rim; null without rotation
    Real h;              // s
    Real half_h;         // s
    Real per_h;          // 1/s
    Real until_end;      // s, from the start of the substep to the end of the step
    bool ends_move;      // whether some do
    Real recovery;       // share of an error that the first sweep takes away, by displacement
    Real most;           // largest correction, in lengths of the rod; of hinges, m; of angles, rad
    Real over_relaxation;
};

}  // namespace carom

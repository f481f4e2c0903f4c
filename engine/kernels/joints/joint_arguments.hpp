#pragma once

#include <cstddef>
#include <cstdint>

// Plain arguments of the kernels that sweep over joints (solver `soft`): rods between centres, rods between
// anchors, hinges; springs and ropes; wheels and sliders; limits, motors and springs of angles. Columns are
// padded and 64-byte aligned; `first` and `last` are multiples of kRowPadding. Records of bodies are those of
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
    const std::int32_t* a;  // row
    const std::int32_t* b;  // row
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
    // Only of wheels and sliders. Their normal is the axis, start_x and the others are those of a hinge, and
    // arm_a reaches to b's anchor.
    Real *axis_x, *axis_y;  // no unit, at the start of the step
    Real* across;           // N s, across the axis
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
    bool has_springs;    // whether some of these joints do spring; if not, their impulses are zero
    bool has_motors;     // likewise
    Real recovery;       // share of an error that the first sweep takes away, by displacement
    Real most;           // largest correction, in lengths of the rod; of hinges, m; of angles, rad
    Real over_relaxation;
};

/// Most bodies of a mechanism that is swept in a bundle: what a batch of them needs is in the first cache.
inline constexpr std::size_t kMostBodiesOfBundle = 32;

/// Mechanisms of hinges that are joined alike, a lane each; lanes beyond `mechanisms` have a row at rest. The
/// joint number j of each of them is in the places first + kJointBlock j ... of the columns of its kind.
struct JointBundle {
    std::size_t mechanisms;                      // 1 ... kJointBlock
    std::size_t bodies, first_body;              // of a mechanism; of all bundles, in SweepBundles::rows
    std::size_t hinges, first_hinge;             // of a mechanism; place
    std::size_t angles, first_angle;             // likewise
    std::size_t branches = 0, first_branch = 0;  // of the tree that its hinges are, if they are one; in all
    bool hangs = false;                          // body 0 of each mechanism is the world, where it hangs
};

/// A hinge of a tree of bodies: from the body nearer to the root to the one beyond it.
struct JointBranch {
    std::size_t hinge;           // of a mechanism
    std::int32_t angle;          // likewise, its part about the angle; below zero: it has none
    std::int32_t parent, child;  // numbers of bodies of the mechanism
    bool parent_is_a;            // of the hinge
};

/// Gauss-Seidel sweeps over mechanisms, each on its own: over its hinges, then over what acts on its angles.
template <class Real>
struct SweepBundles {
    // The columns a and b are numbers of bodies within their bundle; other members are as in any sweep.
    SweepJoints<Real> hinges, angles;
    const JointBundle* bundles;
    const std::int32_t* rows;  // [bodies of all bundles][kJointBlock]
    bool gives;                // first the impulses that joints had at the end of the step before
    bool begins;               // whether the first of two sweeps is that of a substep
};

/// Inertia of what does not turn, as far as that is solved for [kg m²].
inline constexpr double kNoTurn = 1e30;

/// Closes hinges that are open, by displacement, in mechanisms that are trees.
template <class Real>
struct CloseBundles {
    SweepJoints<Real> hinges;   // as in SweepBundles
    JointColumns<Real> angles;  // likewise
    const JointBundle* bundles;
    const std::int32_t* rows;     // [bodies of all bundles][kJointBlock]
    const JointBranch* branches;  // of each bundle that is a tree: a parent comes before its children
    Real open;   // a mechanism is closed if a hinge is open by more than this share of a limb
    Real left;   // share of a limb that is left open at most
    int rounds;  // at most: a turn closes a gap in first order alone
};

/// Mechanisms at the start of a step. Of joints a and b are numbers of bodies within their bundle, and
/// impulses are those of the step before; the start_ and seen_ columns are written.
template <class Real>
struct BeginBundles {
    JointColumns<Real> hinges, angles;
    const JointBundle* bundles;
    const std::int32_t* rows;                     // [bodies of all bundles][kJointBlock]
    const Real *position_x, *position_y, *angle;  // m, rad, of bodies by row; angle is null without rotation
    const double *hung_x, *hung_y;                // m, [bundles][kJointBlock], where mechanisms hang
    const double* inertia;                        // kg m², [bodies of all bundles][kJointBlock]
    const double *anchor_a_x, *anchor_a_y;        // m, in the frame of the body, by the place of the hinge
    const double *anchor_b_x, *anchor_b_y;        //
    const double* angle_at_zero;                  // rad, at which an angle counts as 0, by its place
    double least_inertia;                         // s: times how joints turn a body back [N s m]
    double* longest;                              // [bundles], out: m, the longest component of an arm
};

}  // namespace carom

#pragma once

#include <cstddef>
#include <cstdint>

#include "narrowphase/manifold.hpp"
#include "shapes/convex_shape.hpp"

// Plain arguments of the kernels that find the contacts of convex shapes. Columns are padded and 64-byte
// aligned; `first` and `last` are multiples of kRowPadding, so there is no tail.

namespace carom {

/// Where two convex shapes touch: two points on one line, or one point. The normal leads from body a to body
/// b, the tangent is the normal turned by a quarter counter-clockwise; points are ordered along it.
///
/// Levers belong to the points half way between the surfaces, so that both bodies get an impulse at the same
/// place: r leads there from the body's centre of mass.
template <class Real>
struct ManifoldColumns {
    Real *normal_x, *normal_y;        // no unit
    Real *lever_a1, *lever_a2;        // m, r x normal of both points, about the centre of a
    Real *lever_b1, *lever_b2;        // m, about the centre of b
    Real *lever_a_t, *lever_b_t;      // m, r . normal = r x tangent, the same for both points
    Real *separation1, *separation2;  // m; a single point is the first, then the second is kNoPoint.
                                      // Both are kNoPoint where shapes are farther apart than the margin
};

/// Angles that are turned into cosines and sines at once; their arrays are 64-byte aligned.
inline constexpr std::size_t kAnglesOfBlock = 64;

/// Rows of bodies whose poses are followed: solvers/manifolds/poses/pose_watch.hpp. All columns by row.
template <class Real>
struct WatchPoses {
    const Real *x, *y, *angle;                     // m, m, rad; angle is null where nothing turns
    const Real *velocity_x, *velocity_y, *spin;    // m/s, m/s, rad/s; spin likewise
    const Real *radius, *rim;                      // m; null where one value serves all
    Real uniform_radius, uniform_rim;              // m
    const Real* thinnest;                          // m, of the thinnest contact of each
    Real dt;                                       // s
    Real carried_share, carried_arc, carried_way;  // of the thinnest contact: what counts as not moved
    Real* pose;        // in and out, [rows][4]: x, y [m], of the step before; cosine, sine, left as they are
    Real* last_angle;  // in and out: rad, of the step before
    Real* base;        // in and out, [rows][4]: x, y [m], angle [rad] where contacts were found; unused
    Real *come, *turned;  // out: [rows][2] m and [rows] m of the rim, since the step before
    Real *moved, *way;  // out: m, that a surface has come since the step before at most, and may in this one
    std::uint8_t* has_moved;  // out: whether contacts of a row must be found again
};

/// Pairs that wait until their bodies have come near enough.
template <class Real>
struct FindApproached {
    const Real *pose, *frame;  // [rows][4]: x, y [m], cosine, sine of the angle; ShapeFrame
    const Real *come, *way;    // m, by row: since pairs were listed, this step included; in this step
    const Real*
        motion;  // [rows][4]: m in this step in x and y, m of the rim; restitution. None: sides part none
    const std::int32_t *a, *b;  // rows
    const Real* thickness;      // m, by pair
    Real* until;                // in and out: m, of what both have come together
    Real share, fall;           // ContactDistance
    Real rounding;              // share of lengths by which they may be off
    std::int32_t* out;          // numbers of pairs
};

/// Contacts that were found, of which some have to be looked at one by one:
/// solvers/manifolds/finders/gaps.hpp.
template <class Real>
struct QuestionGaps {
    static constexpr std::size_t kContacts = 16;  // of a block: kRowPadding
    const std::int32_t *a, *b;                    // rows
    const Real *velocity_x, *velocity_y, *spin;   // m/s, m/s, rad/s, by row; spin is null where nothing turns
    const Real* radius;                           // m, by row; null where one value serves all
    Real uniform_radius;                          // m
    const Real *thickness, *restitution;          // m, no unit, by contact
    ManifoldColumns<Real> found;
    Real dt;             // s
    Real share, fall;    // ContactDistance
    Real beside, swift;  // of the thickness: separations of corners beside each other, ways of what is swift,
    Real passing;        // and how far behind the gap what passes is at least
    Real far;            // of both radii: gaps of bodies that are far apart
};

/// Contacts of pairs of convex shapes.
template <class Real>
struct FindManifolds {
    const Real* pose;  // [rows][4]: x, y [m], cosine and sine of the angle
    // [rows][4], or null: m in x and y and rad by which each has come there; the fourth is not read. With it
    // separations are those of where bodies came from, along the rows of where they are.
    const Real* come;
    const std::int32_t* shape;        // by row: number in `shapes`
    const ConvexShape<Real>* shapes;  //
    const std::int32_t *a, *b;        // rows of the bodies of each pair
    const Real* margin;               // m, by pair: shapes that are farther apart do not count
    ManifoldColumns<Real> out;
};

}  // namespace carom

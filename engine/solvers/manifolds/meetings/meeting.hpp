#pragma once

#include "narrowphase/convex_impact_time.hpp"
#include "narrowphase/manifold.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Bodies that come farther in a step, in thicknesses of the thinner one, touch where they meet.
inline constexpr double kFastThicknesses = 0.5;
/// Bodies that come as near as this share of their thickness meet.
inline constexpr double kMeetingTarget = 0.02;

/// Bodies that would touch by less than this share of the thickness of the thinner one pass each other. What
/// lies on a surface is deeper in that by up to 0.015 (decision 0037), and slides on to one of the same
/// height.
inline constexpr double kGrazing = 0.03;
/// Only what the plane between two bodies would hold back by as much in a step, in the same shares, may pass:
/// what lies or rolls does not come towards it.
inline constexpr double kPassing = 0.0005;

/// What the places of two bodies at the start of a step do not tell: bodies that in a step fly or turn
/// farther than they are thick touch elsewhere than where they faced each other. Their contact is that of the
/// moment they meet, as they fly; its separations are moved back to the start of the step along its own rows,
/// so that they are zero at that moment.
///
/// Cost: about 0.5 us. Source: conservative advancement, narrowphase/convex_impact_time.hpp.
/// @param thickness  m, of the thinner of the two
/// @param manifold   out, where they meet later than at once
/// @return whether they do
bool meeting_manifold(const MovingConvex& a, const MovingConvex& b, double dt, double thickness,
                      Manifold<double>& manifold);

/// How a body b moves against a body a.
struct RelativeMotion {
    Vec2 velocity{};                // m/s
    double spin_a = 0, spin_b = 0;  // rad/s
};
inline RelativeMotion relative_motion(const MovingConvex& a, const MovingConvex& b) {
    return {b.velocity - a.velocity, a.spin, b.spin};
}

/// Whether bodies with a gap between them come through the plane there in the step: pass_each_other() says
/// whether they meet.
/// @param manifold   at the start of the step
/// @param thickness  m, of the thinner of the two
bool pass_plane(const Manifold<double>& manifold, const RelativeMotion& motion, double dt, double thickness);

/// Whether bodies with a gap between them pass each other in the step, as they fly: a corner beside a corner.
/// The plane between them, which holds for the step, would stop what does not touch. Where one of them has a
/// face there, over which the other comes, it holds.
/// Cost: about 0.5 us where the plane holds something back.
/// @param manifold   at the start of the step, of a gap
/// @param thickness  m, of the thinner of the two
bool pass_each_other(const MovingConvex& a, const MovingConvex& b, const Manifold<double>& manifold,
                     double dt, double thickness);

/// Whether a plane between two bodies is that of a face: one of them has a face along the gap, and what of
/// the other is nearest to it is over it when the gap has closed, farther from its ends than kGrazing.
/// @param gap  m, below zero where they overlap
bool meets_face(const MovingConvex& a, const MovingConvex& b, Vec2 normal, double dt, double gap,
                double thickness);

/// Faces that are opposite each other by no more than this share of the thickness of the thinner body, and no
/// farther apart or deeper in each other, are corners beside each other.
inline constexpr double kBeside = 0.001;

/// Whether bodies are a corner beside a corner and do not come to each other both ways in the step: either of
/// two faces could be the one that holds, and neither is to. A crate that stands on a tile up to its edge is
/// not held by the side of the next one, nor a box by the corners of the columns on either side of it.
/// @param manifold   at the start of the step, of one point
/// @param thickness  m, of the thinner of the two
bool are_beside(const MovingConvex& a, const MovingConvex& b, const Manifold<double>& manifold, double dt,
                double thickness);

/// A body, or a piece of it, as it flies at the start of a step.
/// @param velocity  m/s, of its centre
/// @param shape     its number in the ShapeStore
template <class Real>
MovingConvex moving_row(const WorldState<Real>& world, std::size_t row, Vec2 velocity, std::int32_t shape) {
    const Bodies<Real>& bodies = world.bodies;
    const Vec2 at{bodies.position_x[row], bodies.position_y[row]};
    const bool turns = bodies.has_rotation;
    return {placed(world.shapes[shape], at, {}).shape, at, velocity,
            turns ? static_cast<double>(bodies.angle[row]) : 0,
            turns ? static_cast<double>(bodies.angular_velocity[row]) : 0};
}

/// An edge as a shape that does not move, in the frame of its body.
MovingConvex still_edge(const Edge& edge);

/// Moves separations at a moment back to the start of the step.
/// @param time  s, from the start of the step
void move_back(Manifold<double>& manifold, const RelativeMotion& motion, double time);

}  // namespace carom

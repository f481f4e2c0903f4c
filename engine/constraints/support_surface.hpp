#pragma once

#include <cmath>

#include "broadphase/edge_candidates.hpp"
#include "constraints/partner.hpp"
#include "effects/rolling_resistance.hpp"
#include "narrowphase/coincident.hpp"
#include "narrowphase/disc_edge.hpp"
#include "shapes/walls.hpp"
#include "state/world_state.hpp"

namespace carom {

/// Where a body and what supports it touch.
struct SupportSurface {
    Vec2 normal;        // from the body into the support
    double separation;  // m, at the start of the step, along the normal
    Vec2 velocity;      // m/s, of the surface
    double friction, rolling_resistance;
    double rolling_share;     // of the body's rim speed in the rolling velocity
    double rolling_velocity;  // m/s, the support's share of it
    bool is_flat;             // a wall, or the inside of an edge
    bool is_contact = true;   // false: another edge of the same chain touches there
};

/// The surface of a wall (WallSide), or of a static or kinematic disc.
template <class Real>
SupportSurface surface_of(const WorldState<Real>& world, std::size_t row, Partner support) {
    const Bodies<Real>& bodies = world.bodies;
    const Vec2 x{bodies.position_x[row], bodies.position_y[row]};
    const double radius = bodies.radius[row];
    if (support.is_wall()) {
        const Walls& walls = *world.walls;
        const Vec2 n = wall_normal(support.side());
        const Vec2 corner = wall_corner(walls, support.side());
        return {n,
                dot(corner - x, n) - radius,
                {},
                walls.material.friction,
                walls.material.rolling_resistance,
                1,
                0,
                true};
    }
    const auto other = static_cast<std::size_t>(support.row());
    const Vec2 d = Vec2{bodies.position_x[other], bodies.position_y[other]} - x;
    const double distance = std::sqrt(length_squared(d));
    const Vec2 n = distance > 0 ? (1 / distance) * d
                                : normal_of_coincident(static_cast<std::uint32_t>(row),
                                                       static_cast<std::uint32_t>(other));
    const double support_radius = bodies.radius[other];
    Vec2 velocity{bodies.velocity_x[other], bodies.velocity_y[other]};
    const double rim = bodies.has_rotation ? bodies.angular_velocity[other] * support_radius : 0;
    if (bodies.has_rotation) velocity += rim * Vec2{n.y, -n.x};  // spin times the arm -r n
    const double share = rolling_share(radius, support_radius);
    return {n,
            distance - radius - support_radius,
            velocity,
            bodies.friction[other],
            bodies.rolling_resistance[other],
            share,
            (1 - share) * rim,
            false};
}

/// How an edge, or another one, has held a disc up to now.
enum class EdgeHold : std::uint8_t {
    none,
    pressed,  // the disc pressed on it in the step before
    led,      // it holds the disc on a curve, which leads it through this step
};

/// A disc and an edge in the frame of the edge's body: where the disc is and its way in a step.
/// @param v  m/s, of the disc
struct RelativeWay {
    Vec2 from, way;  // m
};
template <class Real>
RelativeWay relative_way(const Bodies<Real>& bodies, const EdgePose& pose, std::size_t row, Vec2 v,
                         double dt) {
    const Vec2 x{bodies.position_x[row], bodies.position_y[row]};
    const Vec2 from = rotate_back(pose.turn, x - pose.position);
    return {from, rotate_back(pose.end_turn, x + dt * v - pose.end_position) - from};
}

/// How far from touching an edge a disc stays in this step at least [m], and how far it moves relative to
/// the edge's points near it at most. Much cheaper than surface_of_edge, which says it exactly.
struct EdgeClearance {
    double least, way;  // m
};
template <class Real>
EdgeClearance clearance_of_edge(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                                std::size_t row, std::int32_t number, double dt) {
    const Edge& edge = world.edges[number];
    const EdgePose& pose = edges.pose_of(edge);
    const Vec2 v{world.bodies.velocity_x[row], world.bodies.velocity_y[row]};
    const RelativeWay relative = relative_way(world.bodies, pose, row, v, dt);
    const double distance = std::sqrt(distance_squared(relative.from, edge.a, edge.b));
    double way = std::sqrt(length_squared(relative.way));
    // Points of a body that turns differ in their ways by the turn times their distance, and a chord is
    // shorter than its arc by less than the turn times the arc.
    if (const double turn = std::fabs(pose.end_angle - pose.angle); turn > 0) {
        way += turn * (distance + way + dt * std::sqrt(length_squared(v)) +
                       std::sqrt(length_squared(pose.end_position - pose.position)) +
                       turn * std::sqrt(length_squared(relative.from)));
    }
    return {distance - static_cast<double>(world.bodies.radius[row]) - 2 * way, way};
}

/// In the frame of the edge's body, where the edge is at rest and the disc's way is nearly straight, so that
/// a disc is met wherever it comes from, however fast one of them turns. The normal is that of the moment
/// they meet, and so is the velocity of the surface; the separation is such that they then touch.
///
/// What presses already is found in the middle of the step: a disc that rolls to and fro in a bowl of many
/// edges would gain energy from contacts that lag behind it (solvers/manifolds/finders/poses_ahead.hpp).
/// @param v  m/s, of the disc  @param hold  by this edge or another one
template <class Real>
SupportSurface surface_of_edge(const WorldState<Real>& world, const EdgeCandidates<Real>& edges,
                               std::size_t row, std::int32_t number, Vec2 v, double dt, EdgeHold hold) {
    const Bodies<Real>& bodies = world.bodies;
    const Edge& edge = world.edges[number];
    const EdgePose& pose = edges.pose_of(edge);
    const double radius = bodies.radius[row];
    const auto [p, way] = relative_way(bodies, pose, row, v, dt);

    const double met = time_of_meeting(p, way, edge.a, edge.b, radius);
    // Edges that turn take what they press along: nothing swings on them.
    const bool rolls_on = hold == EdgeHold::led || (hold == EdgeHold::pressed && !pose.turns() &&
                                                    length_squared(way) < radius * radius);
    double time = rolls_on ? 0.5 : met;
    Vec2 there = p + time * way;
    double share = nearest_share(there, edge.a, edge.b);
    // What rolls over the corner rests on one edge after the other.
    if (hold == EdgeHold::none && passes_inner_corner(p, share, world.edges, edge))
        time = 0, there = p, share = nearest_share(p, edge.a, edge.b);
    const Vec2 point = point_at(edge.a, edge.b, share), d = point - there;
    const double distance = std::sqrt(length_squared(d));
    Vec2 n = (1 / distance) * d;
    if (!(distance > 0)) {  // on the line itself: back to where it comes from
        const Vec2 along = edge.b - edge.a;
        const double length = std::sqrt(length_squared(along));
        n = (dot(Vec2{-along.y, along.x}, way) < 0 ? -1 / length : 1 / length) * Vec2{-along.y, along.x};
    }
    // What touches already is held over the whole step: by the normal of its middle, beside which the points
    // of a wall that turns move along it, and where the disc is then, as it may roll on.
    const Rotation turn = turn_at(pose, time > 0 ? time : 0.5);
    const Vec2 held = time > 0 ? there : p + 0.5 * way;
    const Vec2 arm = rotate(turn, point_at(edge.a, edge.b, nearest_share(held, edge.a, edge.b)));
    const Vec2 normal = rotate(turn, n);
    const double spin = (pose.end_angle - pose.angle) / dt;
    const Vec2 surface = (1 / dt) * (pose.end_position - pose.position) + spin * Vec2{-arm.y, arm.x};
    return {normal,
            distance - radius + time * dt * dot(v - surface, normal),
            surface,
            bodies.friction[pose.row],
            bodies.rolling_resistance[pose.row],
            1,
            radius * spin,
            share > 0 && share < 1,
            is_touched_here(there, share, world.edges, edge)};
}

}  // namespace carom

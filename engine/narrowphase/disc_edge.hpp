#pragma once

#include <algorithm>
#include <cmath>

#include "narrowphase/time_of_impact.hpp"
#include "shapes/edges.hpp"

// A disc and an edge, both in the frame of the edge's body, in double precision. An edge is met from both
// sides and at its ends.

namespace carom {

/// Circles in which edges are looked for are so much wider, against rounding of lengths in single precision.
inline constexpr double kWiderCircle = 1 + 1e-6;

/// Share of the way from a to b at which the line comes nearest to p; 0 and 1 at and beyond its ends.
inline double nearest_share(Vec2 p, Vec2 a, Vec2 b) {
    const Vec2 along = b - a;
    return std::clamp(dot(p - a, along) / length_squared(along), 0.0, 1.0);
}

inline Vec2 point_at(Vec2 a, Vec2 b, double share) {
    return share == 1 ? b : a + share * (b - a);
}

inline double distance_squared(Vec2 p, Vec2 a, Vec2 b) {
    return length_squared(p - point_at(a, b, nearest_share(p, a, b)));
}

/// Whether p is farther than `reach` from the box around an edge, and so from the edge: most that are looked
/// at are, and it is a third of the work of distance_squared().
inline bool is_beyond_box(Vec2 p, const Edge& edge, double reach) {
    return std::min(edge.a.x, edge.b.x) - p.x > reach || p.x - std::max(edge.a.x, edge.b.x) > reach ||
           std::min(edge.a.y, edge.b.y) - p.y > reach || p.y - std::max(edge.a.y, edge.b.y) > reach;
}

/// Whether a disc at p whose nearest point of an edge is at `share` touches that edge, and not the next or
/// the one before: at a joint of a chain only one of the two may push, else a disc that rolls over the joint
/// is kicked. Where the nearest point lies inside the next edge, that one pushes; a corner both have belongs
/// to the edge that ends there.
inline bool is_touched_here(Vec2 p, double share, const EdgeStore& edges, const Edge& edge) {
    if (share == 0) return edge.previous < 0;
    if (share == 1 && edge.next >= 0) return nearest_share(p, edge.b, edges[edge.next].b) == 0;
    return true;
}

/// Whether a disc is over an edge, but its way ends beyond the corner where the chain bends towards it: the
/// next edge keeps it from there, and it may meet both.
/// @param share  of the edge, nearest to where its way ends
inline bool passes_inner_corner(Vec2 p, double share, const EdgeStore& edges, const Edge& edge) {
    if (share > 0 && share < 1) return false;
    const std::int32_t neighbour = share == 0 ? edge.previous : edge.next;
    if (neighbour < 0) return false;
    const double now = nearest_share(p, edge.a, edge.b);
    const Vec2 along = edge.b - edge.a, far = share == 0 ? edges[neighbour].a : edges[neighbour].b;
    return now > 0 && now < 1 && cross(along, p - edge.a) * cross(along, far - edge.a) > 0;
}

namespace disc_edge {

/// When p0 + t way comes within `radius` of the corner, for t in [0, 1] and p0 outside; else 2.
inline double time_at_corner(Vec2 p0, Vec2 way, Vec2 corner, double radius) {
    const Vec2 d = p0 - corner;
    const DiscApproach<double> discs(d.x, d.y, way.x, way.y, radius);
    const double discriminant = discs.discriminant();
    if (!(discs.approach < 0 && discriminant > 0)) return 2;
    const double t = discs.time_of_impact(discriminant);
    return t <= 1 ? t : 2;
}

/// When it comes within `radius` of the inside of the edge.
inline double time_at_side(Vec2 p0, Vec2 way, Vec2 a, Vec2 b, double radius) {
    const Vec2 along = b - a;
    const double length = std::sqrt(length_squared(along));
    const double height = cross(along, p0 - a) / length, climb = cross(along, way) / length;
    const double distance = std::fabs(height), approach = height > 0 ? -climb : climb;
    if (!(approach > 0 && distance > radius)) return 2;
    const double t = (distance - radius) / approach;
    if (!(t <= 1)) return 2;
    const double place = dot(p0 + t * way - a, along);
    return place >= 0 && place <= length * length ? t : 2;
}

}  // namespace disc_edge

/// The share of a straight way from p0 at which a disc meets an edge, or is nearest to it if it does not; 0
/// if it overlaps it already. The distance to an edge along a line is convex, so there is one such place.
inline double time_of_meeting(Vec2 p0, Vec2 way, Vec2 a, Vec2 b, double radius) {
    using namespace disc_edge;
    double nearest = distance_squared(p0, a, b);
    if (nearest <= radius * radius || length_squared(way) == 0) return 0;
    const double meeting = std::min({time_at_side(p0, way, a, b, radius), time_at_corner(p0, way, a, radius),
                                     time_at_corner(p0, way, b, radius)});
    if (meeting <= 1) return meeting;
    // The distance is least, or begins to be least if the way is parallel to the edge, at one of the way's
    // ends or beside a corner.
    double time = 0;
    const auto try_at = [&](double t) {
        t = std::clamp(t, 0.0, 1.0);
        const double there = distance_squared(p0 + t * way, a, b);
        if (there < nearest) nearest = there, time = t;
    };
    const double inverse = 1 / length_squared(way);
    try_at(inverse * dot(a - p0, way)), try_at(inverse * dot(b - p0, way)), try_at(1);
    return time;
}

}  // namespace carom

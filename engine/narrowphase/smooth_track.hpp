#pragma once

#include <cmath>
#include <cstdint>
#include <optional>

#include "narrowphase/disc_edge.hpp"
#include "shapes/edges.hpp"

// Chains that stand for curves: edges that bend little from one to the next. What is held on one follows it.

namespace carom {

/// A chain that bends by no more than this at a corner stands for a curve; where it bends more it has a
/// corner, at which what comes without restitution loses the speed that it has into the next edge. A circle
/// of 32 edges is a curve. rad, its sine.
inline constexpr double kSmoothBend = 0.2;
/// rad, its sine, in two steps: by less edges are in a line, as far as a disc feels.
inline constexpr double kLeastBend = 1e-4;
/// Ways over more corners than this are not followed.
inline constexpr int kMostCornersOfWay = 512;

/// From one edge's end to the other.
inline Vec2 direction_of(const Edge& edge) {
    const Vec2 along = edge.b - edge.a;
    return (1 / std::sqrt(length_squared(along))) * along;
}

/// The edge of a curve that is nearest to p, found along the chain from an edge near it: the lines that halve
/// the angles at its corners part the edges. Negative if a corner that is none of a curve, or an end of the
/// chain, lies between.
inline std::int32_t edge_of_curve(const EdgeStore& edges, std::int32_t from, Vec2 p) {
    for (int corners = 0; corners < kMostCornersOfWay; ++corners) {
        const Edge& edge = edges[from];
        const Vec2 along = direction_of(edge);
        // 1: p is beyond that end, and the way on is smooth; -1: beyond it, and there is none; 0: before it.
        const auto beyond = [&](Vec2 corner, double sign, std::int32_t neighbour) {
            const Vec2 other = neighbour < 0 ? along : direction_of(edges[neighbour]);
            if (!(sign * dot(p - corner, along + other) > 0)) return 0;
            return neighbour >= 0 && dot(along, other) > 0 && std::fabs(cross(along, other)) <= kSmoothBend
                       ? 1
                       : -1;
        };
        const int after = beyond(edge.b, 1, edge.next), before = beyond(edge.a, -1, edge.previous);
        if (after < 0 || before < 0) return -1;
        if (after == 0 && before == 0) return from;
        from = after > 0 ? edge.next : edge.previous;
    }
    return -1;
}

/// A disc at an edge of a curve, in the frame of its edges.
struct DiscOnCurve {
    std::int32_t edge;
    double radius;            // m
    Vec2 position, velocity;  // m, m/s
    Vec2 fall;                // m/s, what gravity adds in the step
    double substep;           // s
};

/// The velocity of a disc that a curve holds, turned as the curve turns.
///
/// A velocity is that of a chord, from the step before, and the next chord makes an angle θ = v dt / R with
/// it. To be stopped at the curve's normal takes v² θ² / 2 from the disc, and 1 - exp(-2 π θ) of its energy
/// in a turn of a circle; what really holds it does no work. So its velocity is turned: as far as to end the
/// step, a parabola of free flight, where the disc touches the curve.
/// @return nothing where the disc does not run into a curve that bends towards it; or comes in by more than
/// the curve turns and gravity makes in a step, and so lands on it; or is so slow that gravity, not the
/// curve, makes its way
inline std::optional<Vec2> lead_along_curve(const EdgeStore& edges, const DiscOnCurve& disc, double dt) {
    constexpr int kTurns = 4;          // each leaves about the square of what was lacking
    constexpr double kLeastFalls = 8;  // speed, in what gravity adds in a step
    const Vec2 p = disc.position, velocity = disc.velocity, fall = disc.fall;
    const double radius = disc.radius, substep = disc.substep;
    const double speed = std::sqrt(length_squared(velocity)), falls = std::sqrt(length_squared(fall));
    if (!(speed > kLeastFalls * falls)) return {};
    const std::int32_t here = edge_of_curve(edges, disc.edge, p);
    if (here < 0) return {};
    const auto edge_at_end = [&](Vec2 v) { return edge_of_curve(edges, here, p + dt * (v + 0.5 * fall)); };
    // Two steps are what the last chord and the next lie on.
    std::int32_t last = edge_at_end(velocity);
    const std::int32_t behind = edge_of_curve(edges, here, p - dt * velocity),
                       first = behind < 0 ? here : behind;
    if (last < 0 || last == first) return {};
    const double side = cross(direction_of(edges[here]), p - edges[here].a) > 0 ? 1 : -1,
                 sense = dot(velocity, direction_of(edges[here])) < 0 ? -side : side,
                 bend = sense * cross(direction_of(edges[first]), direction_of(edges[last]));
    if (!(bend > kLeastBend)) return {};
    Vec2 led = velocity;
    for (int turn = 0; turn < kTurns; ++turn) {
        const Vec2 along = direction_of(edges[last]), away = side * Vec2{-along.y, along.x};
        // A contact stops what would touch after a substep at the velocity of its end, which is sooner.
        const double sooner = -0.5 * substep * substep / dt * dot(fall, away);
        const double depth =
            radius + std::fmax(sooner, 0.0) - dot(p + dt * (led + 0.5 * fall) - edges[last].a, away);
        if (turn == 0 && !(depth > 0)) return {};
        led = dt * led + depth * away;
        led = (speed / std::sqrt(length_squared(led))) * led;
        last = edge_at_end(led);
        if (last < 0) return {};
    }
    const double turned = sense * cross(velocity, led) / (speed * speed);
    if (!(turned > 0) || turned > bend + falls / speed || !(dot(velocity, led) > 0)) return {};
    return led;
}

}  // namespace carom

#pragma once

#include <carom/vec2.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "math/vec2_math.hpp"
#include "shapes/convex_shape.hpp"

// What tests of convex shapes hold results against: supports of vertices in double precision, over every
// direction that can matter. Nothing is shared with engine/narrowphase.

namespace carom::test {

/// A convex shape where it is: vertices in the world, counter-clockwise, and the rounding.
struct PlacedShape {
    std::vector<Vec2> vertices;
    double radius = 0;
    Vec2 centre;
    double inradius = 0;
};

/// From the vertices of a shape alone, in the order they have.
/// @param pose  x, y, cosine and sine
template <class Real>
PlacedShape place(const ConvexShape<Real>& shape, const Real* pose) {
    const double x = pose[0], y = pose[1], cosine = pose[2], sine = pose[3];
    PlacedShape placed{{}, shape.radius, {x, y}, shape.inradius};
    placed.vertices.reserve(static_cast<std::size_t>(shape.count));
    for (std::int32_t i = 0; i < shape.count; ++i) {
        const double vx = shape.x[i], vy = shape.y[i];
        placed.vertices.push_back({x + cosine * vx - sine * vy, y + sine * vx + cosine * vy});
    }
    return placed;
}

/// A convex shape of these vertices (counter-clockwise, about their centre of mass) with exact normals.
template <class Real>
ConvexShape<Real> make_convex_shape(const std::vector<Vec2>& vertices, double radius) {
    ConvexShape<Real> shape{};
    const std::size_t count = vertices.size();
    double extent = 0, inradius = count == 1 ? 0 : 1e300;
    for (std::size_t i = 0; i < std::size_t{kMostVertices}; ++i) {
        const std::size_t at = i < count ? i : count - 1;
        const Vec2 v = vertices[at], along = vertices[(at + 1) % count] - v;
        const double length = std::sqrt(length_squared(along));
        shape.x[i] = static_cast<Real>(v.x), shape.y[i] = static_cast<Real>(v.y);
        shape.normal_x[i] = count == 1 ? Real(0) : static_cast<Real>(along.y / length);
        shape.normal_y[i] = count == 1 ? Real(0) : static_cast<Real>(-along.x / length);
        extent = std::fmax(extent, std::sqrt(length_squared(v)));
        if (count > 1) inradius = std::fmin(inradius, std::fabs(cross(along, v)) / length);
    }
    shape.radius = static_cast<Real>(radius);
    shape.extent = static_cast<Real>(extent + radius);
    shape.inradius = static_cast<Real>(inradius + radius);
    shape.count = static_cast<std::int32_t>(count);
    return shape;
}

/// How far b lies beyond a along a unit vector, roundings included; negative if they overlap along it. The
/// answer is `least` where the gap is no greater, which is often known from few of the vertices.
inline double gap_along(const PlacedShape& a, const PlacedShape& b, Vec2 n, double least = -1e300) {
    // std::max in place of std::fmax, which is a call of a function: tests ask for a billion gaps.
    double farthest = -1e300, nearest = 1e300, gap = 1e300;
    const std::size_t count_a = a.vertices.size(), count_b = b.vertices.size();
    for (std::size_t i = 0; i < std::max(count_a, count_b); ++i) {
        if (i < count_a) farthest = std::max(farthest, dot(n, a.vertices[i] - a.centre));
        if (i < count_b) nearest = std::min(nearest, dot(n, b.vertices[i] - a.centre));
        gap = nearest - farthest - a.radius - b.radius;
        if (gap <= least) return least;
    }
    return gap;
}

/// The distance of two convex shapes: the greatest gap there is along any direction. Of shapes whose polygons
/// overlap minus the least way along a normal of an edge that parts them.
/// @param enough  the answer is any from it to the distance where that is as large
inline double signed_distance(const PlacedShape& a, const PlacedShape& b, double enough = 1e300) {
    double best = a.vertices.size() + b.vertices.size() == 2 ? gap_along(a, b, {0, 0}) : -1e300;
    const auto try_along = [&](Vec2 way) {
        const double length = std::sqrt(length_squared(way));
        if (length > 0) best = std::max(best, gap_along(a, b, 1 / length * way, best));
    };
    for (const Vec2 p : a.vertices)
        for (const Vec2 q : b.vertices) {
            try_along(q - p);
            if (best >= enough) return best;
        }
    for (const PlacedShape* shape : {&a, &b})
        for (std::size_t i = 0; i < shape->vertices.size(); ++i) {
            const Vec2 along = shape->vertices[(i + 1) % shape->vertices.size()] - shape->vertices[i];
            try_along({along.y, -along.x}), try_along({-along.y, along.x});
        }
    return best;
}

inline double signed_distance(Vec2 point, const PlacedShape& shape) {
    return signed_distance({{point}, 0, point, 0}, shape);
}

}  // namespace carom::test

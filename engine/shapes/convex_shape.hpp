#pragma once

#include <cstdint>

namespace carom {

/// Vertices that a convex shape may have.
inline constexpr int kMostVertices = 8;

/// A convex shape in the frame of its body: the origin is the centre of mass, the body's angle is zero. It is
/// the polygon of its vertices grown by `radius`: a disc has one vertex, a capsule two.
///
/// Arrays are as long for every shape, so that kernels read any of them alike: places at and beyond `count`
/// repeat the last vertex and the last normal.
template <class Real>
struct alignas(64) ConvexShape {
    Real x[kMostVertices], y[kMostVertices];  ///< m, vertices, counter-clockwise
    /// Outward unit normals of the edges: i leads from vertex i to the next. Of two vertices: both sides of
    /// the line; of one: zero.
    Real normal_x[kMostVertices], normal_y[kMostVertices];
    Real radius;         ///< m, of the rounding, >= 0
    Real extent;         ///< m, from the origin to the farthest point, rounding included
    Real inradius;       ///< m, least distance from the origin to the surface
    std::int32_t count;  ///< 1 ... kMostVertices
};

}  // namespace carom

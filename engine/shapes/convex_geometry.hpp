#pragma once

#include <carom/shapes.hpp>

#include <array>

#include "math/rotation.hpp"
#include "shapes/convex_shape.hpp"

namespace carom {

/// Discs, boxes, capsules and polygons; not segments and chains.
bool is_convex(const Shape& shape);

/// The polygon that a convex shape is, grown by a radius, in the frame in which it is given:
/// counter-clockwise; a disc has one vertex, a capsule two. Without vertices for segments and chains.
struct Outline {
    std::array<Vec2, kMostVertices> vertices{};  // m
    int count = 0;
    double radius = 0;  // m

    Vec2 after(int i) const { return vertices[static_cast<std::size_t>(i + 1 < count ? i + 1 : 0)]; }
};
Outline outline_of(const Shape& shape);

/// A convex shape with its centroid at the origin.
/// @param shape  convex, within its limits
template <class Real>
ConvexShape<Real> convex_shape_of(const Shape& shape);

/// How far a convex shape reaches from its centre in a direction [m].
/// @param direction  of length 1
template <class Real>
double reach_along(const ConvexShape<Real>& shape, Rotation turn, Vec2 direction);

extern template ConvexShape<float> convex_shape_of(const Shape&);
extern template ConvexShape<double> convex_shape_of(const Shape&);
extern template double reach_along(const ConvexShape<float>&, Rotation, Vec2);
extern template double reach_along(const ConvexShape<double>&, Rotation, Vec2);

}  // namespace carom

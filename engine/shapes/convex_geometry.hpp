#pragma once

#include <carom/shapes.hpp>

#include <array>

#include "math/rotation.hpp"
#include "shapes/convex_shape.hpp"

namespace carom {

/// Discs, boxes, capsules and polygons; not segments, chains and compounds.
bool is_convex(const Shape& shape);
/// All but segments and chains.
bool has_area(const Shape& shape);

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

/// A convex shape somewhere in the frame of a body: its extent is measured from the body's centre, its
/// inradius is its own.
/// @param shape  convex; its centroid comes to lie at `centre` [m], turned by `angle` [rad]
template <class Real>
ConvexShape<Real> convex_shape_of(const Shape& shape, Vec2 centre, double angle);

/// How far a convex shape reaches from its centre in a direction [m].
/// @param direction  of length 1
template <class Real>
double reach_along(const ConvexShape<Real>& shape, Rotation turn, Vec2 direction);

extern template ConvexShape<float> convex_shape_of(const Shape&);
extern template ConvexShape<double> convex_shape_of(const Shape&);
extern template ConvexShape<float> convex_shape_of(const Shape&, Vec2, double);
extern template ConvexShape<double> convex_shape_of(const Shape&, Vec2, double);
extern template double reach_along(const ConvexShape<float>&, Rotation, Vec2);
extern template double reach_along(const ConvexShape<double>&, Rotation, Vec2);

}  // namespace carom

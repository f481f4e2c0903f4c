#pragma once

#include "narrowphase/convex.hpp"
#include "narrowphase/placed_convex.hpp"

// Inside of placed_convex.cpp and convex_edge.cpp: pairs of one lane.

namespace carom {
namespace {

/// The polygon of a shape in its own frame.
inline void take_polygon(const ConvexShape<double>& shape, Polygons<double>& polygon) {
    for (int i = 0; i < kMostVertices; ++i) {
        polygon.x[i] = shape.x[i], polygon.y[i] = shape.y[i];
        polygon.normal_x[i] = shape.normal_x[i], polygon.normal_y[i] = shape.normal_y[i];
    }
    polygon.count = shape.count, polygon.last = kMostVertices - 1;
}

/// The manifold of a pair as it is seen from a face, with its normal out of the frame of a.
inline Manifold<double> manifold_from(const FacedPair<double>& faced, Rotation turn_of_a) {
    Manifold<double> found = manifold_of<true, double>(faced);
    const Vec2 n = rotate(turn_of_a, {found.normal_x, found.normal_y});
    found.normal_x = n.x, found.normal_y = n.y;
    return found;
}

}  // namespace
}  // namespace carom

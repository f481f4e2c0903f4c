#pragma once

#include <algorithm>

#include "narrowphase/convex.hpp"
#include "narrowphase/placed_convex.hpp"

// Inside of placed_convex.cpp, convex_impact_time.cpp and convex_edge.cpp: pairs of one lane.

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

/// Two shapes that are looked at in one place after the other: their polygons are taken once.
class MovablePair {
  public:
    MovablePair(const ConvexShape<double>& a, const ConvexShape<double>& b) {
        take_polygon(a, pair_.a), take_polygon(b, own_b_);
        pair_.radius_a = a.radius, pair_.radius_b = b.radius;
        pair_.size = std::min(a.inradius, b.inradius);
    }
    /// The pair in the frame of a.
    const ConvexPair<double>& placed(Vec2 centre_a, Rotation turn_a, Vec2 centre_b, Rotation turn_b) {
        const Vec2 to_b = rotate_back(turn_a, centre_b - centre_a);
        const Vec2 turn = rotate_back(turn_a, {turn_b.cos, turn_b.sin});
        pair_.b = own_b_;
        place(pair_.b, turn.x, turn.y, to_b.x, to_b.y);
        pair_.b_x = to_b.x, pair_.b_y = to_b.y;
        return pair_;
    }
    /// As separation_of(PlacedConvex, PlacedConvex): the face that is farthest, without a preference for that
    /// of a, which would cost a thousandth of the size.
    Separation separation(Vec2 centre_a, Rotation turn_a, Vec2 centre_b, Rotation turn_b) {
        const ConvexPair<double>& pair = placed(centre_a, turn_a, centre_b, turn_b);
        const Face<double> of_a = farthest_face<double>(pair.a, pair.b);
        const Face<double> of_b = farthest_face<double>(pair.b, pair.a);
        const bool swapped = of_b.separation > of_a.separation;
        Face<double> face = swapped ? of_b : of_a;
        if (face.normal_x == 0 && face.normal_y == 0) face.normal_x = 1;  // two discs
        FacedPair<double> faced;
        view_from<double>(face, swapped, pair, faced);
        const Manifold<double> found = manifold_from(faced, turn_a);
        return {std::min(found.separation1, found.separation2), {found.normal_x, found.normal_y}};
    }

  private:
    ConvexPair<double> pair_;
    Polygons<double> own_b_;  // in its own frame
};

}  // namespace
}  // namespace carom

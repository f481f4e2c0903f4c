#include "narrowphase/placed_convex.hpp"

#include <algorithm>

#include "narrowphase/placed_pair.hpp"

namespace carom {
template <class Real>
PlacedConvex placed(const ConvexShape<Real>& shape, Vec2 centre, Rotation turn) {
    PlacedConvex found{{}, centre, turn};
    ConvexShape<double>& to = found.shape;
    for (int i = 0; i < kMostVertices; ++i) {
        to.x[i] = shape.x[i], to.y[i] = shape.y[i];
        to.normal_x[i] = shape.normal_x[i], to.normal_y[i] = shape.normal_y[i];
    }
    to.radius = shape.radius, to.extent = shape.extent, to.inradius = shape.inradius;
    to.count = shape.count;
    return found;
}

Manifold<double> manifold_of(const PlacedConvex& a, const PlacedConvex& b) {
    FacedPair<double> faced;
    MovablePair pair(a.shape, b.shape);
    find_face<double>(pair.placed(a.centre, a.turn, b.centre, b.turn), faced);
    return manifold_from(faced, a.turn);
}

Separation separation_of(const PlacedConvex& a, const PlacedConvex& b) {
    return MovablePair(a.shape, b.shape).separation(a.centre, a.turn, b.centre, b.turn);
}

double overlap_of(const PlacedConvex& a, const PlacedConvex& b) {
    return std::max(0.0, -separation_of(a, b).distance) / std::min(a.shape.inradius, b.shape.inradius);
}

template PlacedConvex placed(const ConvexShape<float>&, Vec2, Rotation);
template PlacedConvex placed(const ConvexShape<double>&, Vec2, Rotation);

}  // namespace carom

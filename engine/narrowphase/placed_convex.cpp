#include "narrowphase/placed_convex.hpp"

#include <algorithm>

#include "narrowphase/placed_pair.hpp"

namespace carom {
namespace {

ConvexPair<double> pair_of(const PlacedConvex& a, const PlacedConvex& b) {
    ConvexPair<double> pair;
    take_polygon(a.shape, pair.a), take_polygon(b.shape, pair.b);
    const Vec2 to_b = rotate_back(a.turn, b.centre - a.centre);
    const Vec2 turn = rotate_back(a.turn, {b.turn.cos, b.turn.sin});
    place(pair.b, turn.x, turn.y, to_b.x, to_b.y);
    pair.b_x = to_b.x, pair.b_y = to_b.y;
    pair.radius_a = a.shape.radius, pair.radius_b = b.shape.radius;
    pair.size = std::min(a.shape.inradius, b.shape.inradius);
    return pair;
}

}  // namespace

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
    find_face<double>(pair_of(a, b), faced);
    return manifold_from(faced, a.turn);
}

/// The face that is farthest, without a preference for that of a: it would cost a thousandth of the size.
Separation separation_of(const PlacedConvex& a, const PlacedConvex& b) {
    const ConvexPair<double> pair = pair_of(a, b);
    const Face<double> of_a = farthest_face<double>(pair.a, pair.b);
    const Face<double> of_b = farthest_face<double>(pair.b, pair.a);
    const bool swapped = of_b.separation > of_a.separation;
    Face<double> face = swapped ? of_b : of_a;
    if (face.normal_x == 0 && face.normal_y == 0) face.normal_x = 1;  // two discs
    FacedPair<double> faced;
    view_from<double>(face, swapped, pair, faced);
    const Manifold<double> found = manifold_from(faced, a.turn);
    return {std::min(found.separation1, found.separation2), {found.normal_x, found.normal_y}};
}

double overlap_of(const PlacedConvex& a, const PlacedConvex& b) {
    return std::max(0.0, -separation_of(a, b).distance) / std::min(a.shape.inradius, b.shape.inradius);
}

template PlacedConvex placed(const ConvexShape<float>&, Vec2, Rotation);
template PlacedConvex placed(const ConvexShape<double>&, Vec2, Rotation);

}  // namespace carom

#pragma once

#include "math/rotation.hpp"
#include "narrowphase/manifold.hpp"
#include "shapes/convex_shape.hpp"

// Single pairs of convex shapes, in double precision: what is asked for few bodies, or only to measure.

namespace carom {

/// A convex shape where it is.
struct PlacedConvex {
    ConvexShape<double> shape;
    Vec2 centre;  // m
    Rotation turn;
};

/// Any shape in double precision.
template <class Real>
PlacedConvex placed(const ConvexShape<Real>& shape, Vec2 centre, Rotation turn);

/// Where two convex shapes touch, as the kernel find_manifolds() finds it, whatever their distance.
Manifold<double> manifold_of(const PlacedConvex& a, const PlacedConvex& b);

/// How far apart two convex shapes are, and the normal from a to b along which they are.
struct Separation {
    double distance;  // m; negative: the least overlap along a normal of an edge
    Vec2 normal;
};
Separation separation_of(const PlacedConvex& a, const PlacedConvex& b);

/// How deep two convex shapes overlap, as a share of the smaller inradius; 0 if they do not.
double overlap_of(const PlacedConvex& a, const PlacedConvex& b);

extern template PlacedConvex placed(const ConvexShape<float>&, Vec2, Rotation);
extern template PlacedConvex placed(const ConvexShape<double>&, Vec2, Rotation);

}  // namespace carom

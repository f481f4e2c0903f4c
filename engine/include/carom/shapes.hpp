#pragma once

#include <carom/vec2.hpp>

#include <cstddef>
#include <variant>
#include <vector>

namespace carom {

/// A disc around the body's position.
struct Disc {
    double radius = 0.5;  ///< m, > 0
};

/// A line between two points of the body's frame, without thickness; discs touch it from both sides and at
/// its ends. For static and kinematic bodies.
struct Segment {
    Vec2 a{-0.5, 0};  ///< m
    Vec2 b{0.5, 0};   ///< m, not a
};

/// Lines from point to point of the body's frame. A disc that rolls over a point where two of them meet feels
/// one surface, not two edges. For static and kinematic bodies.
struct Chain {
    std::vector<Vec2> points{};  ///< m; 2 (of a loop 3) ... kLargestChainPoints, each unlike the one before
    bool loop = false;           ///< a last line leads back to the first point
};

/// A rectangle around the body's position, its sides along the body's x and y.
struct Box {
    double width = 1;   ///< m, along x, > 0
    double height = 1;  ///< m, along y, > 0
};

/// All points within `radius` of a line of `length` along the body's x, whose middle is the body's position.
struct Capsule {
    double length = 1;    ///< m, between the two centres, > 0
    double radius = 0.5;  ///< m, > 0
};

/// All points within `radius` of a convex polygon: with a radius its corners are round.
///
/// Vertices may be given in either direction and anywhere: the shape is recentred, so that its centroid, the
/// rounding included, is the body's position. A body's position is its centre of mass, whatever its shape;
/// `recentred` says where the vertices are then.
struct Polygon {
    std::vector<Vec2> vertices{};  ///< m; kFewestPolygonVertices ... kLargestPolygonVertices, convex
    double radius = 0;             ///< m, >= 0
};

/// The geometry of a body. Boxes, capsules and polygons are the convex shapes beside the disc.
using Shape = std::variant<Disc, Segment, Chain, Box, Capsule, Polygon>;

/// What mass and motion need of a shape of uniform density.
struct MassProperties {
    double area = 0;           ///< m²
    Vec2 centroid{};           ///< m, in the frame in which the shape is given
    double second_moment = 0;  ///< m⁴, integral of the squared distance from the centroid over the area: a
                               ///< body's moment of inertia is its mass times it over the area
};

/// Exact, rounding included: nothing is sampled. All are zero for segments and chains, which have no area.
/// @param shape  within its limits (`Scene::validate`)
/// Source: Steiner's decomposition of a parallel body: the polygon, a rectangle on each of its edges and a
/// sector of a disc at each of its vertices.
MassProperties mass_properties_of(const Shape& shape);

/// The polygon as a body has it: counter-clockwise, its centroid at (0, 0).
/// @param polygon  within its limits (`Scene::validate`)
Polygon recentred(const Polygon& polygon);

/// Points are looked at one by one whenever bodies have moved far.
inline constexpr std::size_t kLargestChainPoints = 65536;

inline constexpr std::size_t kFewestPolygonVertices = 3;
inline constexpr std::size_t kLargestPolygonVertices = 8;
/// Farthest point of a box, capsule or polygon from its centroid over the nearest of its surface. Beyond it
/// single precision does not tell the sides of a plank apart.
inline constexpr double kLargestAspect = 1000;
/// Sine of the angle by which a polygon turns at a vertex, at least.
inline constexpr double kSmallestCornerSine = 1e-3;
/// A polygon's shortest edge is at least this share of its extent.
inline constexpr double kSmallestEdgeShare = 1e-3;

}  // namespace carom

#pragma once

#include <carom/materials.hpp>
#include <carom/vec2.hpp>

#include <cstddef>
#include <optional>
#include <variant>
#include <vector>

namespace carom {

/// A disc around the body's position.
struct Disc {
    double radius = 0.5;  ///< m, > 0
};

/// A line between two points of the body's frame, without thickness; bodies touch it from both sides and at
/// its ends. For static and kinematic bodies. Static ones that lie end to end are felt as one chain.
struct Segment {
    Vec2 a{-0.5, 0};  ///< m
    Vec2 b{0.5, 0};   ///< m, not a
};

/// Lines from point to point of the body's frame. What slides or rolls over a point where two of them meet
/// feels one surface, not two edges. For static and kinematic bodies. A chain that comes back to its first
/// point is a loop as well: its last point and the first are one.
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

/// A convex shape of a compound, placed in the compound's frame.
struct Piece {
    std::variant<Disc, Box, Capsule, Polygon> shape{};  ///< a polygon's vertices stay where they are given
    Vec2 position{};                                    ///< m, of the origin of the shape's own frame
    double angle = 0;                                   ///< rad, counter-clockwise
    std::optional<Material> material{};                 ///< left out: the body's
};

/// Several convex shapes that are one body, concave as a whole: an L, a cross, a wheel with teeth.
///
/// Pieces may be given anywhere: like a polygon, a compound is recentred, so that its centre of mass is the
/// body's position. Pieces may overlap; mass and moment of inertia are the sums over pieces, so that what
/// overlaps counts twice.
struct Compound {
    std::vector<Piece> pieces{};  ///< 1 ... kLargestPieceCount
};

/// The geometry of a body. Boxes, capsules and polygons are the convex shapes beside the disc.
using Shape = std::variant<Disc, Segment, Chain, Box, Capsule, Polygon, Compound>;

/// What mass and motion need of a shape of uniform density.
struct MassProperties {
    double area = 0;           ///< m²
    Vec2 centroid{};           ///< m, in the frame in which the shape is given
    double second_moment = 0;  ///< m⁴, integral of the squared distance from the centroid over the area: a
                               ///< body's moment of inertia is its mass times it over the area
};

/// Exact, rounding included: nothing is sampled. Of a compound the sums over its pieces, where a piece
/// without a material counts as one of the standard density. All are zero for segments and chains, which have
/// no area.
/// @param shape  within its limits (`Scene::validate`)
/// Source: Steiner's decomposition of a parallel body: the polygon, a rectangle on each of its edges and a
/// sector of a disc at each of its vertices.
MassProperties mass_properties_of(const Shape& shape);

/// The polygon as a body has it: counter-clockwise, its centroid at (0, 0).
/// @param polygon  within its limits (`Scene::validate`)
Polygon recentred(const Polygon& polygon);

/// The compound as a body has it: its centre of mass at (0, 0), polygons around their own centroids.
/// @param standard  material of the pieces that have none
/// @param compound  within its limits (`Scene::validate`)
Compound recentred(const Compound& compound, const Material& standard = {});

/// Pieces are looked at one by one wherever a compound is near something.
inline constexpr std::size_t kLargestPieceCount = 256;

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

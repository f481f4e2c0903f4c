#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "narrowphase/placed_convex.hpp"
#include "shapes/edges.hpp"

// A convex shape on what supports it: a wall, or the edges of a segment or chain, which are met from both
// sides and at their ends. In double precision; a is the body, b the support.

namespace carom {

/// Where a convex shape touches a half plane: its side that faces it most, or one point. Levers of b are
/// about `point`.
/// @param normal  into the wall, of length 1
/// @param point   any of its surface [m]
Manifold<double> manifold_on_plane(const PlacedConvex& body, Vec2 normal, Vec2 point);

/// Where a convex shape touches a chain: one manifold for edges that lie in one line, so that joints between
/// them do not exist for a body that slides over them.
struct ChainManifold {
    Manifold<double> manifold;  // levers of b are about the origin of the chain's frame
    std::int32_t edge;          // number of the edge at the lowest point
    double height;              // m, of the line over the origin, along the normal; 1e15: of what is no line
};

/// What of a chain touches a convex shape, both in the frame of the chain's body. At a joint an edge pushes
/// only along normals between its own and half way to its neighbour's, else joints would kick what slides
/// over them: the rest is the neighbour's.
/// @param near    numbers of the edges of one body that may touch, ascending
/// @param margin  m: what is farther away does not count
/// @param found   is appended to, lowest edge number first
/// Cost: two separations of a segment and the shape for each edge.
void find_chain_manifolds(const PlacedConvex& body, std::span<const Edge> edges,
                          std::span<const std::int32_t> near, double margin,
                          std::vector<ChainManifold>& found);

}  // namespace carom

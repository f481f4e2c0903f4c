#pragma once

#include <carom/scene.hpp>

#include <cstddef>
#include <vector>

namespace carom::tool {

/// A box, capsule or polygon for pictures: a polygon around the body's centre of mass, counter-clockwise,
/// grown by a radius; a capsule has two vertices.
struct ShapeOutline {
    std::vector<Vec2> vertices;        // m
    double radius = 0;                 // m
    std::vector<ShapeOutline> pieces;  // of a compound, which has no vertices
};

/// Without vertices for discs, segments and chains.
ShapeOutline outline_of(const Body& body);

/// m, from the centre to the farthest point; zero for segments and chains.
double extent_of(const Body& body);

/// The distinct outlines of a scene.
struct Outlines {
    std::vector<ShapeOutline> shapes;
    std::vector<double> of_body;  ///< number in `shapes`, or -1; empty if no body has one
};
Outlines outlines_of(const std::vector<Body>& bodies);

}  // namespace carom::tool

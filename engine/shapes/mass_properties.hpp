#pragma once

#include <carom/shapes.hpp>

namespace carom {

/// What mass and motion need of a shape of uniform density.
struct MassProperties {
    double area = 0;           ///< m²
    Vec2 centroid;             ///< m, in the frame in which the shape is given
    double second_moment = 0;  ///< m⁴, integral of the squared distance from the centroid over the area
};

/// Exact, rounding included: nothing is sampled. All are zero for segments and chains, which have no area.
/// @param shape  within its limits; a polygon counter-clockwise or not
/// Source: the polygon, a rectangle on each of its edges and a sector of a disc at each of its vertices
/// (Steiner's decomposition of a parallel body); of the sum over them area and moments are polynomials, but
/// for the angle of each sector.
MassProperties mass_properties_of(const Shape& shape);

}  // namespace carom

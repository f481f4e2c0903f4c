#include "shapes/compound.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/vec2_math.hpp"
#include "shapes/convex_geometry.hpp"

namespace carom {
namespace {

/// Where the centroid of a piece is, in the frame of the compound [m].
Vec2 centre_of(const Piece& piece, const MassProperties& of) {
    return piece.position + rotate(rotation_by(piece.angle), of.centroid);
}

}  // namespace

CompoundMass compound_mass_of(const Compound& compound, const Material& standard) {
    CompoundMass sum;
    for (const Piece& piece : compound.pieces) {
        const MassProperties of = mass_properties_of(shape_of(piece));
        const double mass = material_of(piece, standard).density * of.area;
        sum.area += of.area, sum.mass += mass;
        sum.centre += mass * centre_of(piece, of);
    }
    if (!(sum.mass > 0)) return sum;
    sum.centre = (1 / sum.mass) * sum.centre;
    for (const Piece& piece : compound.pieces) {  // Steiner: each about the common centre
        const MassProperties of = mass_properties_of(shape_of(piece));
        const double density = material_of(piece, standard).density;
        sum.inertia +=
            density * (of.second_moment + of.area * length_squared(centre_of(piece, of) - sum.centre));
    }
    return sum;
}

Compound recentred(const Compound& compound, const Material& standard) {
    const Vec2 centre = compound_mass_of(compound, standard).centre;
    Compound found = compound;
    for (Piece& piece : found.pieces) {
        piece.position = centre_of(piece, mass_properties_of(shape_of(piece))) - centre;
        if (auto* polygon = std::get_if<Polygon>(&piece.shape)) *polygon = recentred(*polygon);
    }
    return found;
}

CompoundSize compound_size_of(const Compound& compound, const Material& standard) {
    CompoundSize size;
    size.thinnest = std::numeric_limits<double>::infinity();
    for (const Piece& piece : recentred(compound, standard).pieces) {
        const ConvexShape<double> shape =
            convex_shape_of<double>(shape_of(piece), piece.position, piece.angle);
        size.extent = std::max(size.extent, shape.extent);
        size.thinnest = std::min(size.thinnest, shape.inradius);
        size.thickest = std::max(size.thickest, shape.inradius);
    }
    return size;
}

double reach_along(const Compound& compound, const Material& standard, Rotation turn, Vec2 direction) {
    double reach = -std::numeric_limits<double>::infinity();
    for (const Piece& piece : recentred(compound, standard).pieces)
        reach =
            std::max(reach, reach_along(convex_shape_of<double>(shape_of(piece), piece.position, piece.angle),
                                        turn, direction));
    return reach;
}

}  // namespace carom

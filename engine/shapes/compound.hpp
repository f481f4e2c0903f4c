#pragma once

#include <carom/shapes.hpp>

#include "math/rotation.hpp"

namespace carom {

/// What a piece is made of.
inline const Material& material_of(const Piece& piece, const Material& standard) {
    return piece.material ? *piece.material : standard;
}

inline Shape shape_of(const Piece& piece) {
    return std::visit([](const auto& shape) { return Shape(shape); }, piece.shape);
}

/// Sums over the pieces of a compound.
struct CompoundMass {
    double area = 0;     // m²
    double mass = 0;     // kg
    Vec2 centre;         // m, of mass
    double inertia = 0;  // kg m², about it
};
/// @param standard  material of pieces that have none
CompoundMass compound_mass_of(const Compound& compound, const Material& standard);

/// How far a compound reaches, and how thick it is [m].
struct CompoundSize {
    double extent = 0;    // from the centre of mass to the farthest point
    double thinnest = 0;  // the smallest inradius of a piece
    double thickest = 0;  // the largest
};
/// How far a compound reaches from its centre of mass in a direction [m].
/// @param direction  of length 1
double reach_along(const Compound& compound, const Material& standard, Rotation turn, Vec2 direction);
CompoundSize compound_size_of(const Compound& compound, const Material& standard);

}  // namespace carom

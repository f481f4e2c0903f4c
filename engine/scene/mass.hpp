#pragma once

#include <carom/scene.hpp>

#include <cmath>

#include "math/angle.hpp"
#include "shapes/mass_properties.hpp"

namespace carom {

inline bool is_disc(const Shape& shape) {
    return std::holds_alternative<Disc>(shape);
}

/// Zero for what is no disc.
inline double radius_of(const Shape& shape) {
    const Disc* disc = std::get_if<Disc>(&shape);
    return disc ? disc->radius : 0;
}

inline double area_of(const Shape& shape) {  // m²
    return mass_properties_of(shape).area;
}

/// Radius of the disc that has the mass and the moment of inertia of a shape [m], whatever its density: the
/// moment of inertia is mass rim² / 2. Zero for segments and chains.
inline double rim_of(const Shape& shape) {
    if (const Disc* disc = std::get_if<Disc>(&shape)) return disc->radius;
    const MassProperties of = mass_properties_of(shape);
    return of.area > 0 ? std::sqrt(2 * of.second_moment / of.area) : 0;
}

inline double mass_of(const Body& body) {  // kg
    return body.mass ? *body.mass : body.material.density * area_of(body.shape);
}

}  // namespace carom

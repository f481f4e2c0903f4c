#pragma once

#include <carom/scene.hpp>

#include <cmath>

#include "math/angle.hpp"

namespace carom {

inline bool is_disc(const Shape& shape) {
    return std::holds_alternative<Disc>(shape);
}

/// Zero for what is no disc.
inline double radius_of(const Shape& shape) {
    const Disc* disc = std::get_if<Disc>(&shape);
    return disc ? disc->radius : 0;
}

/// Radius of the disc that has the mass and the moment of inertia of a body [m], whatever its mass: the
/// moment of inertia is mass rim² / 2. Zero for segments and chains.
inline double rim_of(const Body& body) {
    if (is_disc(body.shape)) return radius_of(body.shape);
    if (std::holds_alternative<Compound>(body.shape)) {
        const BodyMass of = body_mass_of(body);
        return std::sqrt(2 * of.inertia / of.mass);
    }
    const MassProperties of = mass_properties_of(body.shape);
    return of.area > 0 ? std::sqrt(2 * of.second_moment / of.area) : 0;
}

/// Whether contacts turn a body even without friction: their impulses pass its centre of mass on one side.
inline bool is_turned_by_contacts(const Body& body) {
    return body.type == BodyType::dynamic_body && !is_disc(body.shape) && !body.fixed_rotation;
}

inline double mass_of(const Body& body) {  // kg
    return body.mass ? *body.mass : body_mass_of(body).mass;
}

}  // namespace carom

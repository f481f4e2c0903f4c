#pragma once

#include <carom/scene.hpp>
#include <carom/world.hpp>

#include <numbers>

namespace carom::tool {

/// Zero for what is no disc.
inline double radius_of(const Body& body) {
    const Disc* disc = std::get_if<Disc>(&body.shape);
    return disc ? disc->radius : 0;
}

/// kg: given, or density times area.
inline double mass_of(const Body& body) {
    const double radius = radius_of(body);
    return body.mass.value_or(body.material.density * std::numbers::pi * radius * radius);
}

/// kg m², of a solid disc about its centre.
inline double inertia_of(const Body& body) {
    return 0.5 * mass_of(body) * radius_of(body) * radius_of(body);
}

/// Translation and rotation of one solid disc [J].
inline double kinetic_energy_of(const Body& body, const BodyState& state) {
    if (body.type == BodyType::static_body) return 0;
    return 0.5 * mass_of(body) * (state.velocity.x * state.velocity.x + state.velocity.y * state.velocity.y) +
           0.5 * inertia_of(body) * state.angular_velocity * state.angular_velocity;
}

}  // namespace carom::tool

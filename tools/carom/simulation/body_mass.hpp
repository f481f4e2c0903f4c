#pragma once

#include <carom/scene.hpp>
#include <carom/world.hpp>

namespace carom::tool {

/// kg: given, or density times area.
inline double mass_of(const Body& body) {
    return body.mass ? *body.mass : body_mass_of(body).mass;
}

/// kg m², of a solid body about its centre of mass.
inline double inertia_of(const Body& body) {
    return body_mass_of(body).inertia;
}

/// Translation and rotation [J].
inline double kinetic_energy_of(const BodyMass& mass, const BodyState& state) {
    return 0.5 * mass.mass * (state.velocity.x * state.velocity.x + state.velocity.y * state.velocity.y) +
           0.5 * mass.inertia * state.angular_velocity * state.angular_velocity;
}

/// Of one solid body [J].
inline double kinetic_energy_of(const Body& body, const BodyState& state) {
    if (body.type == BodyType::static_body) return 0;
    return kinetic_energy_of(body_mass_of(body), state);
}

}  // namespace carom::tool

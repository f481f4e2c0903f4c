#include "solvers/soft/contacts/contact_settings.hpp"

#include "effects/touching.hpp"

namespace carom {
namespace {

/// Bodies that start a step with an overlap of this share of the smaller radius are parted at its end.
constexpr double kDeep = 0.1;

}  // namespace

double ContactSettings::deep_overlap(double smaller_radius) {
    return kDeep * smaller_radius;
}

template <class Real>
void read_effects(const WorldState<Real>& world, ContactSettings& settings) {
    const Bodies<Real>& bodies = world.bodies;
    const bool friction_varies = !bodies.friction.is_uniform(), radius_varies = !bodies.radius.is_uniform();
    ContactEffects& effects = settings.effects;
    effects.friction = world.effects.friction, settings.has_rotation = world.effects.rotation;
    effects.restitution = world.effects.restitution, effects.rolling = world.effects.rolling_resistance;
    settings.is_smooth_heap = carom::is_smooth_heap(world);
    settings.heaves_if_slender = carom::heaves_if_slender(world);
    effects.friction_varies = effects.friction && friction_varies;
    effects.rolling_varies = effects.rolling && !bodies.rolling_resistance.is_uniform();
    effects.radius_varies = effects.rolling_share_varies = radius_varies;
    settings.friction = friction_varies ? 0 : static_cast<double>(bodies.friction.uniform_value());
    settings.rolling = static_cast<double>(bodies.rolling_resistance.uniform_value());
    settings.radius = radius_varies ? 1 : static_cast<double>(bodies.radius.uniform_value());
}

/// A body that falls from rest, in substeps h of g h each, beside one that is held, comes nearer by
/// g dt (dt + h) / 2 at most.
void ContactSettings::set_lengths(const SubstepTerms& terms) {
    fall = 0.5 * terms.fall_speed() * terms.dt * (terms.dt / terms.substep_dt + 1);
    largest_correction = kPushRadiiPerSecond * radius * terms.substep_dt;
}

template void read_effects(const WorldState<float>&, ContactSettings&);
template void read_effects(const WorldState<double>&, ContactSettings&);

}  // namespace carom

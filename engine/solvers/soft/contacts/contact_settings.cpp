#include "solvers/soft/contacts/contact_settings.hpp"

#include <algorithm>

#include "effects/touching.hpp"

namespace carom {
namespace {

/// Bodies that start a step with an overlap of this share of the smaller radius are parted at its end.
constexpr double kDeep = 0.1;

// The next three are shares of the longest substep that gravity allows, in which a body falls by 0.005 of the
// usual radius from rest. docs/decisions/0095-piles-under-any-step.md has the measurements.
/// Substeps as long as this get one sweep more, and another one for each time as long.
constexpr double kLengthOfSweep = 0.2;
/// Shorter ones close gaps of contacts that carry something, and take away overlaps, no faster than these.
constexpr double kUnhurried = 0.13;
/// They do so by this share of it at least, for gravity may be weak.
constexpr double kLeastPace = 1. / 16;

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
void ContactSettings::set_lengths(const SubstepTerms& terms, double longest_substep) {
    // Beyond 1 where no more substeps are taken.
    const double length =
        longest_substep > 0 ? std::min(terms.substep_dt / longest_substep, 1.0) : kUnhurried;
    pace = std::clamp(length / kUnhurried, kLeastPace, 1.0);
    next_sweeps = iterations - 1;
    if (next_sweeps > 0) next_sweeps = std::max(next_sweeps, static_cast<int>(length / kLengthOfSweep));
    fall = 0.5 * terms.fall_speed() * terms.dt * (terms.dt / terms.substep_dt + 1);
    largest_correction = kPushRadiiPerSecond * radius * terms.substep_dt;
}

template void read_effects(const WorldState<float>&, ContactSettings&);
template void read_effects(const WorldState<double>&, ContactSettings&);

}  // namespace carom

#pragma once

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/books.hpp"

namespace carom::test {

/// Half the distance from 1 to the next number up: the largest relative error of one rounding.
template <class Real>
inline constexpr double kRounding = std::numeric_limits<Real>::epsilon() / 2;

/// Every effect that can be forced on.
inline EffectOverrides all_effects() {
    return {.continuous = true,
            .ledger = true,
            .gravity = true,
            .drag = true,
            .rotation = true,
            .restitution = true,
            .friction = true};
}

/// Those, and what only a solver with rough contacts has.
inline EffectOverrides all_rough_effects() {
    EffectOverrides effects = all_effects();
    effects.rolling_resistance = true;
    return effects;
}

inline double dynamic_mass(const Scene& scene) {  // kg
    double mass = 0;
    for (const Body& body : scene.bodies)
        if (body.type == BodyType::dynamic_body) {
            const double radius = std::get<Disc>(body.shape).radius;
            mass += body.mass.value_or(body.material.density * std::numbers::pi * radius * radius);
        }
    return mass;
}

inline bool has_friction(const Scene& scene) {
    return std::any_of(scene.bodies.begin(), scene.bodies.end(),
                       [](const Body& body) { return body.material.friction > 0; });
}

/// A scene stepped twice side by side: with the effects it calls for alone, and with all effects on, those it
/// does not call for with the value zero. Both must have the same bits, and the second one's books must
/// close.
template <class Real>
class Trial {
  public:
    explicit Trial(const Scene& scene, WorldOptions options = {})
        : world(scene, options),
          all_on(scene, with_all_effects(options, world.plan().solver == "soft" && has_friction(scene))),
          mass_(dynamic_mass(scene)) {}

    void step(double dt) {
        world.step(dt);
        all_on.step(dt);
    }
    void run(int steps, double dt) {
        for (int i = 0; i < steps; ++i) step(dt);
    }
    BodyState state(std::uint32_t body) const { return world.state({body, 0}); }

    /// What has to hold for every scene. `scale`: the energy the scene has to do with [J], if the ledger
    /// cannot know it.
    void check(double scale = 0) const {
        CHECK(world.state_hash() == all_on.state_hash());
        check_books_close(all_on, std::fmax(scale, energy_scale(all_on.ledger())), mass_);
        CHECK(world.profile().unresolved_impacts == 0);
        CHECK(world.quarantined().empty());
    }

    BasicWorld<Real> world;
    BasicWorld<Real> all_on;

  private:
    static WorldOptions with_all_effects(WorldOptions options, bool is_rough) {
        options.effects = is_rough ? all_rough_effects() : all_effects();
        return options;
    }
    double mass_;
};

}  // namespace carom::test

#pragma once

#include <carom/profile.hpp>
#include <carom/scene.hpp>

#include <string>
#include <vector>

#include "state/world_state.hpp"

namespace carom {

/// Which effects a scene calls for, its overrides applied, each with the reason.
struct CalledEffects {
    Effects effects;
    std::vector<EffectReport> reports;
    std::string solver_reason;  ///< why the world has its solver
};

/// What is forced by `first`, else by `second`.
EffectOverrides merged(const EffectOverrides& first, const EffectOverrides& second);

/// The only place that asks a scene which effects are on.
/// @param overrides  over the scene's own
CalledEffects call_effects(const Scene& scene, const EffectOverrides& overrides);

}  // namespace carom

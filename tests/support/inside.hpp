#pragma once

#include <memory>

#include "scene/call_effects.hpp"
#include "step/make_simulation.hpp"
#include "world/set_up.hpp"

namespace carom::test {

/// A world's inside without the world around it.
template <class Real>
std::unique_ptr<Simulation<Real>> inside_of(const Scene& scene, Solver solver) {
    auto simulation = make_simulation<Real>(solver);
    set_up(*simulation, scene, {.threads = 1}, call_effects(scene, {}).effects);
    return simulation;
}

}  // namespace carom::test

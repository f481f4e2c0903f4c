#pragma once

#include "math/random.hpp"

#include <carom/scene.hpp>

#include <span>

namespace carom {

/// Adds random velocities whose root mean square speed is `rms` and whose total momentum is zero, both to
/// rounding.
/// @param bodies  at least two, dynamic.
void add_random_velocities(std::span<Body> bodies, double rms, Random& random);

}  // namespace carom

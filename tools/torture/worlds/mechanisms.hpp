#pragma once

#include "torture/random.hpp"
#include "torture/worlds/group.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

/// Bodies around (0, 0) that joints connect: a chain with or without a weight at its end, a net, a figure of
/// limbs, a ring, a cart, a train of gears, or two bodies with a joint of any kind. Nothing moves yet.
/// @param most  bodies, at least 2
Group random_mechanism(const WorldTraits& traits, std::size_t most, Random& random);

/// Whether it draws or turns by itself, or stores energy.
bool has_own_force(const Joint& joint);

}  // namespace carom::torture

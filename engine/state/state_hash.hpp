#pragma once

#include <cstdint>

#include "state/world_state.hpp"

namespace carom {

/// Hash over the bit patterns of position, velocity, angle and spin of all bodies in handle order.
template <class Real>
std::uint64_t hash_of(const WorldState<Real>& world);

extern template std::uint64_t hash_of(const WorldState<float>&);
extern template std::uint64_t hash_of(const WorldState<double>&);

}  // namespace carom

#pragma once

#include <carom/scene.hpp>

#include <cstdint>

namespace carom::torture {

inline constexpr std::int64_t kCrowd = 1800;  // discs of the issue that found the stalls

/// Discs of .2 to .5 m at fill .35 in the air, from 5 m above the floor of an open box up; the box is 40 m
/// wide for 1,800, and narrower for fewer by the square root.
Scene falling_crowd(std::int64_t discs, double restitution, double friction, std::uint64_t seed = 1);

}  // namespace carom::torture

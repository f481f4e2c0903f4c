#pragma once

#include <carom/scene.hpp>

#include "torture/random.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

/// Of what bounds a world: it touches every body, whatever its filter.
inline constexpr std::uint16_t kFenceCategory = 0x8000;

/// m, half of the longest extent of a body, large ones seldom.
double random_size(const WorldTraits& traits, Random& random);

/// A dynamic body at (0, 0), at rest. @param size  m
Body random_body(const WorldTraits& traits, double size, Random& random);
Body body_of(const WorldTraits& traits, const Shape& shape, Random& random);

/// Now and then makes of a dynamic body a static or a kinematic one, at times a line, or a sensor.
void change_kind(Body& body, const WorldTraits& traits, double size, Random& random);

/// m, from the body's position to its farthest point, lines included.
double reach_of(const Body& body);

}  // namespace carom::torture

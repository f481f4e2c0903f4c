#pragma once

#include <carom/shapes.hpp>

#include "torture/random.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

/// A shape of that kind, at most some twice `size` [m] from its centre to its farthest point. Boxes and
/// capsules may be long, polygons have 3 to 8 corners, compounds 2 to 5 pieces.
Shape random_shape(ShapeKind kind, double size, Random& random);

/// A segment, or a zigzag of 2 to 6 edges, along x from -size to size [m].
Shape random_line(double size, Random& random);

}  // namespace carom::torture

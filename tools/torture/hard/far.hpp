#pragma once

#include <carom/scene.hpp>

namespace carom::torture {

/// Ten boxes of 1 m on a floor, so far to the right and up [m].
Scene stack_far_away(double distance);

}  // namespace carom::torture

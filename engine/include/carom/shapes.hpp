#pragma once

#include <variant>

namespace carom {

/// A disc around the body's position.
struct Disc {
    double radius = 0.5;  ///< m, > 0
};

/// The geometry of a body. Discs are what this version builds; the other shapes of the scene format follow.
using Shape = std::variant<Disc>;

}  // namespace carom

#pragma once

namespace carom {

/// A vector of the plane: x to the right, y up. Units as the place says that uses it.
struct Vec2 {
    double x = 0;
    double y = 0;

    friend bool operator==(const Vec2&, const Vec2&) = default;
};

}  // namespace carom

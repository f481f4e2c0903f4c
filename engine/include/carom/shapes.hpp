#pragma once

#include <carom/vec2.hpp>

#include <cstddef>
#include <variant>
#include <vector>

namespace carom {

/// A disc around the body's position.
struct Disc {
    double radius = 0.5;  ///< m, > 0
};

/// A line between two points of the body's frame, without thickness; discs touch it from both sides and at
/// its ends. For static and kinematic bodies.
struct Segment {
    Vec2 a{-0.5, 0};  ///< m
    Vec2 b{0.5, 0};   ///< m, not a
};

/// Lines from point to point of the body's frame. A disc that rolls over a point where two of them meet feels
/// one surface, not two edges. For static and kinematic bodies.
struct Chain {
    std::vector<Vec2> points{};  ///< m; 2 (of a loop 3) ... kLargestChainPoints, each unlike the one before
    bool loop = false;           ///< a last line leads back to the first point
};

/// The geometry of a body. The other shapes of the scene format follow.
using Shape = std::variant<Disc, Segment, Chain>;

/// Points are looked at one by one whenever bodies have moved far.
inline constexpr std::size_t kLargestChainPoints = 65536;

}  // namespace carom

#pragma once

#include <carom/scene.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <type_traits>
#include <utility>

// The walls around a world: up to four half planes that nothing moves. Everything that tells the sides apart
// is here.

namespace carom {

/// Sides of the walls as the `b` of a meeting or of a support: rows are >= 0.
enum WallSide : std::int32_t { kLeft = -1, kRight = -2, kBottom = -3, kTop = -4 };
inline constexpr std::array kWallSides{kLeft, kRight, kBottom, kTop};

/// Calls fn(side) with each side as a type, so that what is asked of a side is known to the compiler.
template <class Fn>
void for_each_wall_side(const Fn& fn) {
    const auto call = [&]<std::size_t... k>(std::index_sequence<k...>) {
        (fn(std::integral_constant<std::int32_t, kWallSides[k]>{}), ...);
    };
    call(std::make_index_sequence<kWallSides.size()>{});
}

inline bool has_wall(const Walls& walls, std::int32_t side) {
    switch (side) {
        case kLeft:
            return walls.left;
        case kRight:
            return walls.right;
        case kBottom:
            return walls.bottom;
        default:
            return walls.top;
    }
}

/// From a body into the wall; no unit.
inline Vec2 wall_normal(std::int32_t side) {
    constexpr Vec2 kNormals[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    return kNormals[-1 - side];
}

/// A point of the wall's surface [m]: the corner that it shares with another one.
inline Vec2 wall_corner(const Walls& walls, std::int32_t side) {
    return side == kLeft || side == kBottom ? walls.min : walls.max;
}

/// Distance of a point from a wall [m]; negative behind it.
inline double wall_clearance(const Walls& walls, std::int32_t side, Vec2 x) {
    switch (side) {
        case kLeft:
            return x.x - walls.min.x;
        case kRight:
            return walls.max.x - x.x;
        case kBottom:
            return x.y - walls.min.y;
        default:
            return walls.max.y - x.y;
    }
}

/// What the walls enclose [m]; infinite where there is none.
template <class Real>
struct Enclosure {
    Real min_x, min_y, max_x, max_y;

    explicit Enclosure(const Walls* walls) {
        constexpr Real kOpen = std::numeric_limits<Real>::infinity();
        min_x = walls && walls->left ? static_cast<Real>(walls->min.x) : -kOpen;
        min_y = walls && walls->bottom ? static_cast<Real>(walls->min.y) : -kOpen;
        max_x = walls && walls->right ? static_cast<Real>(walls->max.x) : kOpen;
        max_y = walls && walls->top ? static_cast<Real>(walls->max.y) : kOpen;
    }

    bool is_outside(Real x, Real y) const { return (x < min_x) | (x > max_x) | (y < min_y) | (y > max_y); }

    /// Distance to the nearest wall; negative behind it.
    Real clearance(Real x, Real y) const {
        return std::min(std::min(x - min_x, max_x - x), std::min(y - min_y, max_y - y));
    }

    /// Calls fn(side) for the walls that something at (x, y) comes to within `reach`.
    template <class Fn>
    void for_each_side_within(Real x, Real y, Real reach, const Fn& fn) const {
        const bool near[] = {x - min_x < reach, max_x - x < reach, y - min_y < reach, max_y - y < reach};
        for (const std::int32_t side : kWallSides)
            if (near[-1 - side]) fn(side);
    }
};

}  // namespace carom

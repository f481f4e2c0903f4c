#pragma once

#include <carom/vec2.hpp>

namespace carom {

constexpr Vec2 operator+(Vec2 a, Vec2 b) {
    return {a.x + b.x, a.y + b.y};
}
constexpr Vec2 operator-(Vec2 a, Vec2 b) {
    return {a.x - b.x, a.y - b.y};
}
constexpr Vec2 operator-(Vec2 a) {
    return {-a.x, -a.y};
}
constexpr Vec2 operator*(double s, Vec2 a) {
    return {s * a.x, s * a.y};
}
constexpr Vec2& operator+=(Vec2& a, Vec2 b) {
    return a = a + b;
}
constexpr Vec2& operator-=(Vec2& a, Vec2 b) {
    return a = a - b;
}

constexpr double dot(Vec2 a, Vec2 b) {
    return a.x * b.x + a.y * b.y;
}
constexpr double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}
constexpr double length_squared(Vec2 a) {
    return dot(a, a);
}

}  // namespace carom

#pragma once

#include <carom/vec2.hpp>

#include <cstdint>

namespace carom {
namespace {

/// Coincident centres have no normal. This is the one they get, from a to b: one of eight directions, which
/// depends on the numbers of both alone, and so neither on time nor on chance; (b, a) has the opposite one.
/// (3, 4, 5) / 5, so that they are unit vectors to the last bit.
/// @param a, b  anything that tells bodies apart: rows where these stay for a step, else slots of handles; of
/// what is no body, any number
inline Vec2 normal_of_coincident(std::uint32_t a, std::uint32_t b) {
    constexpr Vec2 kNormals[] = {{1, 0},  {0.6, 0.8},   {0, 1},  {-0.8, 0.6},
                                 {-1, 0}, {-0.6, -0.8}, {0, -1}, {0.8, -0.6}};
    constexpr std::uint32_t kCount = 8;
    const std::uint32_t choice = a < b ? a + 3 * b : b + 3 * a + kCount / 2;
    return kNormals[choice % kCount];
}

}  // namespace
}  // namespace carom

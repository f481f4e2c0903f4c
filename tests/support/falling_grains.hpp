#pragma once

#include <carom/scene.hpp>

#include "math/random.hpp"

namespace carom::test {

/// Discs of 4 mm in a shaft of 12 of them, over a height of 1.2 m: they fall onto each other, the last ones
/// at more than ten diameters in a step of 1/30 s.
inline Scene grains_that_fall(int count) {
    constexpr double kRadius = 0.004, kHeight = 1.2;  // m
    constexpr int kColumns = 10;
    const Material material{.friction = 0.1, .restitution = 0.6};
    Random random(5);
    Scene scene;
    scene.gravity = {0, -9.8};
    scene.walls = Walls{.min = {0, 0}, .max = {0.096, 1.3}, .material = material};
    const double pitch = kHeight * kColumns / count;  // m, from row to row
    for (int i = 0; i < count; ++i)
        scene.add({.shape = Disc{kRadius},
                   .position = {0.005 + 0.0094 * (i % kColumns) + random.uniform(0, 1e-3),
                                kRadius + pitch * (i / kColumns)},
                   .material = material});
    return scene;
}

}  // namespace carom::test

#pragma once

#include <carom/scene.hpp>

#include <cstdint>

namespace carom::accuracy {

/// Galperin's billiard: a wall at the left, a resting disc of 1 kg, one of `ratio` kg that comes from the
/// right at -1 m/s; all elastic.
inline Scene galperin_scene(double ratio) {
    Material elastic;
    elastic.restitution = 1;
    Scene scene;
    scene.walls = Walls{.min = {0, -10},
                        .max = {1e5, 10},
                        .right = false,
                        .bottom = false,
                        .top = false,
                        .material = elastic};
    scene.add({.shape = Disc{0.5}, .position = {1.5, 0}, .mass = 1, .material = elastic});
    scene.add(
        {.shape = Disc{0.5}, .position = {3, 0}, .velocity = {-1, 0}, .mass = ratio, .material = elastic});
    return scene;
}

/// @return the heavy disc's velocity after so many collisions, impact by impact [m/s]
inline double galperin_velocity(double ratio, std::int64_t collisions) {
    long double light = 0, heavy = -1;
    for (std::int64_t i = 0; i < collisions; ++i) {
        if (i % 2 == 1) {
            light = -light;  // the wall
            continue;
        }
        const long double mean = (light + ratio * heavy) / (1 + ratio);
        light = 2 * mean - light, heavy = 2 * mean - heavy;
    }
    return static_cast<double>(heavy);
}

}  // namespace carom::accuracy

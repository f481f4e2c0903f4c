#pragma once

#include <carom/generators.hpp>
#include <carom/scene.hpp>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace carom::test {

inline Material bouncy(double restitution) {
    return {.restitution = restitution};
}

/// A disc with a mass of its own.
inline Body disc(double radius, double mass, Vec2 position, Vec2 velocity = {}, double restitution = 0) {
    return {.shape = Disc{radius},
            .position = position,
            .velocity = velocity,
            .mass = mass,
            .material = bouncy(restitution)};
}

inline Walls floor_at(double y, double restitution = 0) {
    return {.min = {-1e6, y},
            .max = {1e6, y + 1e6},
            .left = false,
            .right = false,
            .top = false,
            .material = bouncy(restitution)};
}

struct GasOptions {
    std::int64_t count = 1000;
    double packing_fraction = 0.4;
    double velocity_rms = 3;  // m/s
    double restitution = 1;
    double smallest_radius = 0.5, largest_radius = 0.5;  // m
    std::uint64_t seed = 1;
};

/// Discs of 1 kg/m² in a closed square box around the origin, walls as elastic as the discs.
inline Scene gas_scene(const GasOptions& options) {
    const double a = options.smallest_radius, b = options.largest_radius;
    const double mean_square = (a * a + a * b + b * b) / 3;
    const double half = 0.5 * std::sqrt(static_cast<double>(options.count) * std::numbers::pi * mean_square /
                                        options.packing_fraction);
    Scene scene;
    scene.walls = Walls{.min = {-half, -half}, .max = {half, half}, .material = bouncy(options.restitution)};
    Gas gas;
    gas.count = options.count;
    gas.radius = {a, b};
    gas.velocity_rms = options.velocity_rms;
    gas.seed = options.seed;
    gas.body.material = bouncy(options.restitution);
    add_gas(scene, gas);
    return scene;
}

}  // namespace carom::test

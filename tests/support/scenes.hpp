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

/// Galperin's billiard: a wall at x = 0, a resting disc of 1 kg, one of `ratio` kg that comes at -1 m/s; all
/// elastic. They collide floor(pi sqrt(ratio)) times.
inline Scene galperin_billiard(double ratio, Solver solver) {
    Scene scene;
    scene.accuracy.solver = solver;
    scene.walls = Walls{.min = {0, -10},
                        .max = {1e6, 10},
                        .right = false,
                        .bottom = false,
                        .top = false,
                        .material = bouncy(1)};
    scene.add(disc(0.5, 1, {1.5, 0}, {}, 1));
    scene.add(disc(0.5, ratio, {3, 0}, {-1, 0}, 1));
    return scene;
}

/// Newton's cradle: five balls of radius 0.5 m with gaps [m], `moving` of them coming from the left at 2 m/s.
inline Scene cradle(int moving, double gap, Solver solver, double friction = 0) {
    Scene scene;
    scene.accuracy.solver = solver;
    double x = 0;
    for (int i = 0; i < 5; ++i) {
        Body ball = disc(0.5, 1, {x, 0}, {i < moving ? 2.0 : 0.0, 0}, 1);
        ball.material.friction = friction;
        scene.add(ball);
        x += 1 + gap + (i + 1 == moving ? 0.3 : 0);
    }
    return scene;
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

#pragma once

#include <carom/carom.hpp>
#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "support/report.hpp"

#include <doctest/doctest.h>

// Small scenes that together call for every effect and solver that `auto` takes; test_same_bits.cpp keeps
// their hashes, test_joints.cpp those of scenes with joints.

namespace carom::test {

inline Scene gas(std::int64_t count, RadiusRange radius, double restitution) {
    Scene scene;
    scene.name = "gas";
    scene.walls.emplace();
    const double side = std::sqrt(static_cast<double>(count) * 3.2 * radius.max * radius.max / 0.4);
    scene.walls->max = {side, side};
    scene.walls->material.restitution = restitution;
    Gas discs;
    discs.count = count, discs.radius = radius, discs.velocity_rms = 3, discs.seed = 4;
    discs.body.material.restitution = restitution;
    add_gas(scene, discs);
    return scene;
}

inline Scene falling_sizes() {
    Scene scene = gas(300, {0.01, 1}, 0.6);
    scene.name = "falling sizes";
    scene.accuracy.solver = Solver::impulse;
    scene.gravity = {0.5, -9.81};
    scene.drag = {.linear = 0.3, .angular = 0.1};
    scene.bodies[5].angular_velocity = 2;
    return scene;
}

inline Scene moving_obstacles() {
    Scene scene = gas(200, {0.3, 0.5}, 0.8);
    scene.name = "moving obstacles";
    scene.accuracy.solver = Solver::impulse;
    scene.gravity = {0, -5};
    const double side = scene.walls->max.x;
    Body post;
    post.type = BodyType::static_body;
    post.shape = Disc{1.5};
    post.position = {side / 2, side / 3};
    scene.add(post);
    post.type = BodyType::kinematic_body;
    post.position = {2, -3}, post.velocity = {1, 0.5};
    scene.add(post);
    return scene;
}

inline Scene stack_at_rest() {
    Scene scene;
    scene.name = "stack at rest";
    scene.accuracy.solver = Solver::impulse;
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->max = {3, 30};
    Stack discs;
    discs.count = 6, discs.origin = {1.5, 0.5};
    discs.body.material.restitution = 0.5;
    add_stack(scene, discs);
    return scene;
}

/// Solver `soft` with all it has: friction, sizes, bodies that do not turn, restitution, a moving obstacle.
inline Scene rough_sizes() {
    Scene scene = moving_obstacles();
    scene.name = "rough sizes";
    scene.accuracy.solver = Solver::automatic;
    scene.drag = {.linear = 0.1, .angular = 0.1};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Material& material = scene.bodies[i].material;
        material.friction = i % 3 == 0 ? 0.2 : 0.6;
        material.restitution = i % 4 == 0 ? 0.5 : 0;
        scene.bodies[i].fixed_rotation = i % 7 == 0;
    }
    scene.walls->material = {.friction = 0.4};
    return scene;
}

/// Solver `impulse` with friction: sizes, drag, discs that do not turn, one that spins and that nothing
/// moves, and pairs that are hit at one instant.
inline Scene rough_gas() {
    Scene scene = gas(300, {0.2, 0.6}, 1);
    scene.name = "rough gas";
    scene.drag = {.linear = 0.2, .angular = 0.3};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        scene.bodies[i].material.friction = i % 3 == 0 ? 0.1 : 0.5;
        scene.bodies[i].fixed_rotation = i % 7 == 0;
    }
    scene.walls->material.friction = 0.3;
    const double side = scene.walls->max.x;
    scene.walls->max.x += 10;
    scene.add({.type = BodyType::kinematic_body,
               .shape = Disc{1},
               .position = {side + 2, side / 2},
               .velocity = {-1, 0.25},
               .angular_velocity = -5,
               .material = {.friction = 0.7}});
    for (const double y : {0.0, 0.5, -0.5})  // one that breaks two
        scene.add({.shape = Disc{0.5},
                   .position = {side + (y == 0 ? 4 : 6), 4 + y},
                   .velocity = {y == 0 ? 6.0 : 0.0, 0},
                   .angular_velocity = y == 0 ? 3.0 : 0.0,
                   .material = {.friction = 0.4, .restitution = 1}});
    return scene;
}

inline Scene rolling_sizes() {
    Scene scene = rough_sizes();
    scene.name = "rolling sizes";
    scene.accuracy.solver = Solver::automatic;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        scene.bodies[i].material.rolling_resistance = i % 5 == 0 ? 0.3 : 0.05;
    return scene;
}

/// A container that turns, a segment that moves, a static chain under all of them.
inline Scene turning_chain() {
    Scene scene;
    scene.name = "turning chain";
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5, .restitution = 0.3};
    scene.add({.type = BodyType::kinematic_body,
               .shape = Chain{.points = {{-6, -5}, {0, -6}, {6, -5}, {6, 6}, {-6, 6}}, .loop = true},
               .angle = 0.2,
               .angular_velocity = 0.7,
               .material = rough});
    Lattice discs;
    discs.count_x = 9, discs.count_y = 8, discs.origin = {-3.6, -3.2}, discs.spacing = {0.9, 0.9};
    discs.jitter = 0.05, discs.seed = 8, discs.radius_range = RadiusRange{0.25, 0.4};
    discs.body.material = rough;
    add_lattice(scene, discs);
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-0.5, 0}, {0.5, 0.3}},
               .position = {0, 4.5},
               .velocity = {0.3, -1},
               .material = rough});
    scene.add({.type = BodyType::static_body, .shape = Chain{.points = {{-9, -9}, {0, -9.5}, {9, -9}}}});
    scene.add({.shape = Disc{0.5}, .position = {0.1, -8.5}, .material = rough});
    return scene;
}

/// Discs on a floor that fall asleep and are woken by one that drops among them.
inline Scene woken_sleepers() {
    Scene scene;
    scene.name = "woken sleepers";
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 20}, .material = {.friction = 0.5}};
    scene.effects.sleep = true;
    for (int i = 0; i < 30; ++i) {
        const double radius = 0.3 + 0.01 * (i % 5);
        scene.add({.shape = Disc{radius},
                   .position = {0.7 + 0.64 * i, radius},
                   .material = {.friction = 0.4, .rolling_resistance = 0.05}});
    }
    scene.add({.shape = Disc{0.5}, .position = {10.1, 7.3}, .material = {.friction = 0.4}});
    return scene;
}

/// What bounces, each impact at its own time: discs of many restitutions, with friction and without, a
/// segment, a moving disc, walls.
inline Scene bouncing_crowd() {
    Scene scene = gas(100, {0.3, 0.5}, 0.3);
    scene.name = "bouncing crowd";
    scene.gravity = {0, -5};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Material& material = scene.bodies[i].material;
        material.restitution = 0.3 + 0.1 * static_cast<double>(i % 8);
        material.friction = i % 3 == 0 ? 0 : 0.4;
        scene.bodies[i].fixed_rotation = i % 7 == 0;
    }
    scene.walls->material = {.friction = 0.3, .restitution = 0.9};
    const double side = scene.walls->max.x;
    scene.walls->max.x += 6;
    scene.add({.type = BodyType::static_body,
               .shape = Segment{{side + 0.5, 2}, {side + 5.5, 4}},
               .material = {.friction = 0.2, .restitution = 0.8}});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Disc{0.8},
               .position = {side + 2, side / 2},
               .velocity = {-1, 0.25},
               .angular_velocity = 5,
               .material = {.friction = 0.5, .restitution = 0.9}});
    return scene;
}

/// Boxes, capsules, polygons and discs that fall on boxes that nothing moves, one of which turns; some
/// bounce, some do not turn.
inline Scene mixed_shapes() {
    Scene scene;
    scene.name = "mixed shapes";
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5, .restitution = 0.2};
    scene.add({.type = BodyType::static_body, .shape = Box{20, 2}, .position = {0, -1}, .material = rough});
    for (const double side : {-1.0, 1.0})
        scene.add({.type = BodyType::static_body,
                   .shape = Box{1, 30},
                   .position = {7.5 * side, 10},
                   .angle = 0.1 * side,
                   .material = rough});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Capsule{2, 0.3},
               .position = {0, 3},
               .angular_velocity = 1.5,
               .material = rough});
    for (int i = 0; i < 120; ++i) {
        Body body;
        const double size = 0.7 + 0.1 * (i % 4);
        if (i % 4 == 0) body.shape = Box{size, 0.6 * size};
        if (i % 4 == 1) body.shape = Disc{0.4 * size};
        if (i % 4 == 2) body.shape = Capsule{0.5 * size, 0.25 * size};
        if (i % 4 == 3)
            body.shape =
                Polygon{.vertices = {{0, 0}, {size, 0}, {0.8 * size, 0.6 * size}, {0.2 * size, size}},
                        .radius = i % 8 == 3 ? 0.05 : 0};
        body.position = {-5 + 1.1 * (i % 10), 4.5 + 1.2 * (i / 10)};
        body.fixed_rotation = i % 11 == 0;
        body.angle = 0.37 * i, body.angular_velocity = body.fixed_rotation ? 0 : i % 5 - 2;
        body.material = {.friction = i % 3 == 0 ? 0.2 : 0.6, .restitution = i % 6 == 0 ? 0.6 : 0};
        scene.add(body);
    }
    return scene;
}

/// Compounds that fall into one that nothing moves: rings of capsules around a disc, and L-shapes.
inline Scene falling_compounds() {
    Scene scene;
    scene.name = "falling compounds";
    scene.gravity = {0, -10};
    scene.add({.type = BodyType::static_body,
               .shape = Compound{{{.shape = Box{12, 1}, .position = {0, -0.5}},
                                  {.shape = Box{1, 20}, .position = {-6, 9}},
                                  {.shape = Box{1, 20}, .position = {6, 9}}}},
               .material = {.friction = 0.4}});
    for (int i = 0; i < 40; ++i) {
        Compound shape{{{.shape = Box{0.9, 0.3}}, {.shape = Box{0.3, 0.9}, .position = {-0.3, 0.3}}}};
        if (i % 3 == 0) {
            shape.pieces = {{.shape = Disc{0.3}}};
            for (int spoke = 0; spoke < 5; ++spoke)
                shape.pieces.push_back({.shape = Capsule{0.8, 0.05}, .angle = 0.6 * spoke});
        }
        scene.add({.shape = shape,
                   .position = {-4.5 + 1.2 * (i % 8), 1 + 1.3 * (i / 8)},
                   .angle = 0.4 * i,
                   .angular_velocity = i % 5 - 2.0,
                   .material = {.friction = 0.5, .restitution = i % 4 == 0 ? 0.4 : 0}});
    }
    return scene;
}

/// Discs that begin about one place and do not bounce; some do not turn. What contacts give too much there is
/// taken from them.
/// @param mass_ratio  of the heaviest to the lightest
inline Scene discs_about_one_place(const char* name, double mass_ratio) {
    Scene scene;
    scene.name = name;
    scene.accuracy.solver = Solver::automatic;
    for (int i = 0; i < 40; ++i)
        scene.add({.shape = Disc{0.3 + 0.01 * (i % 9)},
                   .position = {0.11 * (i % 7), 0.13 * (i % 5)},
                   .velocity = {2 - 0.7 * (i % 6), 0.9 * (i % 4) - 1},
                   .mass = i % 3 == 0 ? mass_ratio : 1 + 0.1 * (i % 4),
                   .material = {.friction = 0.3},
                   .fixed_rotation = i % 8 == 0});
    return scene;
}

inline std::vector<Scene> golden_scenes() {
    return {mixed_shapes(),
            bouncing_crowd(),
            woken_sleepers(),
            rolling_sizes(),
            gas(400, {0.5, 0.5}, 1),
            falling_sizes(),
            moving_obstacles(),
            stack_at_rest(),
            rough_sizes(),
            turning_chain(),
            rough_gas(),
            falling_compounds(),
            discs_about_one_place("discs about one place", 1),
            discs_about_one_place("uneven discs about one place", 200)};
}

/// Hashes of a scene's state after steps of 1/60 s: the same for every compiler, build and instruction set.
struct Golden {
    const char* scene;
    std::uint64_t single_precision, double_precision;
};

template <class Real>
std::uint64_t hash_after(const Scene& scene, int steps, const WorldOptions& options) {
    BasicWorld<Real> world(scene, options);
    for (int i = 0; i < steps; ++i) world.step(1.0 / 60);
    return world.state_hash();
}

inline void check_golden(const Scene& scene, std::span<const Golden> table, int steps) {
    CAPTURE(scene.name);
    const std::uint64_t single = hash_after<float>(scene, steps, {.threads = 1});
    const std::uint64_t twice = hash_after<double>(scene, steps, {.threads = 1});
    report(std::hex, "{\"", scene.name, "\", 0x", single, ", 0x", twice, "},");
    const auto golden = std::find_if(table.begin(), table.end(),
                                     [&](const Golden& line) { return line.scene == scene.name; });
    REQUIRE(golden != table.end());
    CHECK(single == golden->single_precision);
    CHECK(twice == golden->double_precision);
}

}  // namespace carom::test

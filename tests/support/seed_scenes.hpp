#pragma once

#include <carom/pairwise.hpp>

#include <cstddef>

namespace carom::test {

/// exp(-kSeedDrag * kSeedDt) is 0.98: -ln(0.98) / 0.016, to the last digit [1/s].
inline constexpr double kSeedDrag = 1.2626692073449666;
inline constexpr double kSeedDt = 0.016;  // s
inline constexpr int kSeedSteps = 500;

/// The teaching program's first scene: five discs, looked at and not stepped.
inline PairwiseScene seed_scene_s0() {
    PairwiseScene scene;
    scene.bodies = {
        {.x = 2, .y = 6, .vx = 3, .vy = -1, .mass = 2, .radius = 0.4},
        {.x = 7, .y = 5.5, .vx = -2.5, .vy = 0.5, .mass = 1.5, .radius = 0.35},
        {.x = 5, .y = 7, .vx = 0.5, .vy = -2, .mass = 1, .radius = 0.3},
        {.x = 3.5, .y = 3.5, .vx = 1, .vy = 1.5, .mass = 3, .radius = 0.5},
        {.x = 8, .y = 2.5, .vx = -1, .vy = 2, .mass = 0.8, .radius = 0.25},
    };
    return scene;
}

/// The teaching program's second scene, the one it steps: the same as docs/scenes/seed.json.
inline PairwiseScene seed_scene_s1() {
    PairwiseScene scene;
    scene.bodies = {
        {.x = 2, .y = 6.5, .vx = 3.5, .vy = -0.5, .mass = 2, .radius = 0.4},
        {.x = 7, .y = 5.5, .vx = -2.5, .vy = 0.3, .mass = 1.5, .radius = 0.35},
        {.x = 5, .y = 7, .vx = 0.5, .vy = -2.5, .mass = 1, .radius = 0.3},
        {.x = 3.5, .y = 2.5, .vx = 1.5, .vy = 2.5, .mass = 3, .radius = 0.5},
        {.x = 8, .y = 3, .vx = -1.5, .vy = 1.5, .mass = 0.8, .radius = 0.25},
    };
    scene.gravity_y = -4;
    scene.linear_drag = kSeedDrag;
    scene.restitution = 0.8;
    scene.walls = PairwiseWalls{.max_x = 10, .max_y = 8, .restitution = 0.8};
    return scene;
}

/// Two unit masses running into each other, already 0.2 m into overlap.
inline PairwiseScene seed_head_on_pair() {
    PairwiseScene scene;
    scene.bodies = {{.x = 2, .y = 2, .vx = 2, .mass = 1, .radius = 0.5},
                    {.x = 2.8, .y = 2, .vx = -2, .mass = 1, .radius = 0.5}};
    scene.restitution = 1;
    return scene;
}

}  // namespace carom::test

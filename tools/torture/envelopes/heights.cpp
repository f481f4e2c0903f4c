// How high something stands.
#include <cmath>

#include "torture/envelopes/envelope.hpp"
#include "torture/hard/box_scenes.hpp"
#include "torture/hard/discs.hpp"

namespace carom::torture {
namespace {

constexpr double kLargestSink = 0.01;  // of the height
constexpr int kTenSeconds = 600;

Measures stands(HardRun& run, double height, double farthest) {
    const Shifts shifts(run);
    run.steps(kTenSeconds);
    return {{"sink/height", shifts.sink(run, run.last()) / height, kLargestSink},
            {"shift", shifts.farthest(run), farthest}};
}

Scene column(int discs) {
    constexpr double kRadius = 0.5;
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = shaft_of(kRadius);
    scene.walls->max.y = 2.0 * discs + 10;
    for (int i = 0; i < discs; ++i)
        scene.add({.shape = Disc{kRadius}, .position = {0, kRadius * (2 * i + 1)}});
    return scene;
}

}  // namespace

Envelopes heights() {
    return {
        {.name = "tower-height",
         .title = "unit boxes in a tower, each up to 2 cm aside",
         .criterion = "after 10 s the top has sunk by at most 1 % of the height, no box has moved by 0.5 m",
         .range = {.first = 5, .last = 1280, .stride = 2, .narrow = 1.1, .is_whole = true},
         .seeds = {1, 77},
         .make = [](double value, std::uint64_t seed) { return tower(static_cast<int>(value), 0.02, seed); },
         .run = [](HardRun& run, double value) { return stands(run, value, 0.5); }},
        {.name = "column-height",
         .title = "discs of 1 m in a column, in a shaft",
         .criterion = "after 10 s the top has sunk by at most 1 % of the height",
         .range = {.first = 5, .last = 1280, .stride = 2, .narrow = 1.1, .is_whole = true},
         .seeds = {1},
         .make = [](double value, std::uint64_t) { return column(static_cast<int>(value)); },
         .run = [](HardRun& run, double value) { return stands(run, value, HUGE_VAL); }}};
}

}  // namespace carom::torture

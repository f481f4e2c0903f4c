// Very small beside very large: B6.
#include <algorithm>
#include <cmath>

#include "torture/hard/box_scenes.hpp"
#include "torture/hard/discs.hpp"
#include "torture/hard/passive_rule.hpp"
#include "torture/hard/sizes.hpp"

namespace carom::torture {
namespace {

constexpr double kLargestOverlap = 0.1;  // of the smaller body

Scene one_large_disc(double large, double gravity) {
    const Material rough{.friction = 0.3};
    Scene scene;
    scene.gravity = {0, -gravity};
    scene.walls = Walls{.min = {-1.2 * large, 0}, .max = {1.2 * large, 6 * large}, .material = rough};
    scene.add({.shape = Disc{large}, .position = {0, large}, .material = rough});
    return scene;
}

void add_small(Scene& scene, double small, Vec2 position, Vec2 velocity = {}) {
    scene.add({.shape = Disc{small},
               .position = position,
               .velocity = velocity,
               .material = scene.walls->material});
}

double radius_of(const Scene& scene, std::size_t body) {
    return std::get<Disc>(scene.bodies[body].shape).radius;
}

/// Looks at what the overlap of a pair, in the smaller radius, may not show: the large one and the walls.
void look_at_small(const HardRun& run, Largest& deepest) {
    const Vec2 large = run.place(0);
    const double reach = radius_of(run.scene(), 0), side = run.scene().walls->max.x;
    for (std::size_t i = 1; i < run.count(); ++i) {
        const Vec2 x = run.place(i);
        const double small = radius_of(run.scene(), i);
        deepest.take((reach + small - std::hypot(x.x - large.x, x.y - large.y)) / small);
        deepest.take(1 - (side - std::fabs(x.x)) / small);
        deepest.take(1 - x.y / small);
    }
}

Scene rain(int start) {
    constexpr int kCount = 300;
    constexpr double kSmall = 0.01;  // m
    Scene scene = one_large_disc(10, 10);
    scene.effects.ledger = true;
    for (int i = 0; i < kCount; ++i)
        add_small(scene, kSmall, {-11.5 + 23.0 * i / kCount, 25 + 0.05 * (i % 11)},
                  {0.5 * (i % 5 - 2), -20.0 - 0.1 * start});
    return scene;
}

Measures overlap_of_rain(HardRun& run) {
    constexpr double kLargestUnexplained = 1e-4;
    const double first = run.energy();
    Passive passive(run);
    Largest deepest;
    for (int i = 0; i < 400 && run.step(); ++i) {
        deepest.take(run.overlap());
        look_at_small(run, deepest);
        passive.look(run);
    }
    Measures measures{{"overlap", deepest.value(), kLargestOverlap},
                      {"unexplained", std::fabs(run.unexplained()) / first, kLargestUnexplained}};
    passive.add_to(measures, run);
    return measures;
}

}  // namespace

Scene small_around_large(double ratio) {
    // On its top, and in the corners beside it, as many as there is room for; gravity in units of the small
    // ones, so that they fall alike.
    constexpr double kLarge = 10, kMost = 100;
    const double small = kLarge / ratio;
    Scene scene = one_large_disc(kLarge, 10 * small);
    const int on_top = static_cast<int>(std::fmin(kMost, 0.1 * ratio));
    for (int i = 0; i < on_top; ++i) {
        const double x = 4 * small * (i - 0.5 * on_top);
        add_small(scene, small,
                  {x, kLarge + std::sqrt((kLarge + small) * (kLarge + small) - x * x) + 3 * small * (i % 3)});
    }
    const int beside = static_cast<int>(std::fmin(kMost, 0.1 * ratio));
    for (int i = 0; i < beside; ++i)
        add_small(scene, small,
                  {(i % 2 == 0 ? 1 : -1) * (1.06 * kLarge + 2.7 * small * (i / 2)),
                   2 * small + 3 * small * (i % 5)});
    return scene;
}

Measures overlap_around_large(HardRun& run, int steps) {
    const double small = radius_of(run.scene(), 1);
    Passive passive(run);
    Largest deepest, fastest;
    for (int i = 0; i < steps && run.step(); ++i) {
        deepest.take(run.overlap());
        look_at_small(run, deepest);
        for (std::size_t body = 1; body < run.count(); ++body) fastest.take(run.speed(body));
        passive.look(run);
    }
    Measures measures{{"overlap", deepest.value(), kLargestOverlap}};
    passive.add_to(measures, run);
    measures.push_back({"radii a step", fastest.value() * kUsualStep / small});
    return measures;
}

// Small ones roll off the large one and fall past it, up to 3 of their radii a step. Faster ones than that
// can still be in each other when a step ends, if another body has thrown them there within it.
HardCases small_discs_around_a_large_one(Extent extent) {
    return {{.code = "B6",
             .name = "200 discs around one of 1,000 times their size",
             .make = [] { return small_around_large(1000); },
             .run = [=](HardRun& run) { return overlap_around_large(run, extent.of(2400, 600)); }}};
}

// Where they hit the large one, the floor and each other they are thrown about by more than their size within
// a step.
HardCases rains_on_a_large_disc(Extent extent) {
    std::vector<Scene> more;
    for (int start = 1; start < extent.of(4, 1); ++start) more.push_back(rain(start));
    return {{.code = "B6",
             .name = "rain of discs, 50 radii a step, on one of 1,000 times their size",
             .make = [] { return rain(0); },
             .run = [more](HardRun& run) { return worst_of_all(run, more, overlap_of_rain); }}};
}

HardCases small_boxes_around_a_large_one(Extent) {
    constexpr double kSmall = 0.1, kLarge = 1000 * kSmall;
    return {{.code = "B6",
             .name = "300 boxes on and beside one of 1,000 times their size",
             .make =
                 [] {
                     constexpr double kFriction = 0.5;
                     Scene scene = box_ground(kFriction, 20 * kLarge);
                     scene.add(box_at(0, 0.5 * kLarge, kLarge, kLarge, kFriction));
                     const auto add = [&](double x, double y) {
                         const double angle = 0.3 * jitter_of(scene.bodies.size());
                         scene.add(box_at(x, y, kSmall, kSmall, kFriction, angle));
                     };
                     for (int i = 0; i < 200; ++i) add(0.15 * (i % 20), kLarge + 0.2 + 0.3 * (i / 20));
                     for (int i = 0; i < 100; ++i)
                         add(0.5 * kLarge + 0.2 + 0.15 * (i % 10), 0.2 + 0.3 * (i / 10));
                     return scene;
                 },
             .run = [](HardRun& run) -> Measures {
                 run.steps(400);  // some boxes slide down late
                 double lowest_on = kLarge, lowest_beside = kLarge;
                 for (std::size_t i = 2; i < run.count(); ++i) {
                     const Vec2 at = run.place(i);
                     if (std::fabs(at.x) < 0.5 * kLarge)
                         lowest_on = std::min(lowest_on, at.y - kLarge);
                     else
                         lowest_beside = std::min(lowest_beside, at.y);
                 }
                 constexpr double kLowest = 0.45;  // of a side: a box that lies is at a half
                 return {{"overlap", run.overlap(), kLargestOverlap},
                         {"lowest on it/side", lowest_on / kSmall, kLowest, Sense::at_least},
                         {"lowest beside/side", lowest_beside / kSmall, kLowest, Sense::at_least},
                         {"rms at the end", run.rms_speed(), 1e-2}};
             }}};
}

}  // namespace carom::torture

#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kDiscs = 10;
constexpr double kRadius = 0.5, kHeavy = 10;  // m, mass of the top one over that of the others
constexpr double kSettled = 2, kUntil = 4;    // s

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_of(bouncy(0));
    for (int i = 0; i < kDiscs; ++i)
        scene.add(disc(kRadius, i + 1 < kDiscs ? 1 : kHeavy, {0, (2 * i + 1) * kRadius}, {}, bouncy(0)));
    return scene;
}

/// Largest overlap of neighbours, or of the lowest disc with the floor, over the radius.
double largest_overlap(const Stepper& stepper) {
    double below = -kRadius, largest = 0;
    for (std::size_t i = 0; i < kDiscs; ++i) {
        const double y = stepper.state(i).position.y;
        largest = std::max(largest, (2 * kRadius - (y - below)) / kRadius);
        below = y;
    }
    return largest;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kSettled);
    const double impulse = stepper.simulation().ledger().wall_impulse;
    double overlap = 0;
    for (int i = 1; kSettled + 0.1 * i <= kUntil + 1e-9; ++i) {
        stepper.advance_to(kSettled + 0.1 * i);
        overlap = std::max(overlap, largest_overlap(stepper));
    }
    const double weight = (kDiscs - 1 + kHeavy) * kGravity;
    const double force = (stepper.simulation().ledger().wall_impulse - impulse) / (kUntil - kSettled);
    return {overlap, force / weight - 1};
}

}  // namespace

Case stack() {
    return {.id = "A26",
            .title = "Ten discs on each other, the top one ten times as heavy",
            .kind = "coming to rest",
            .effects = "G N",
            .exact = "rigid discs do not overlap, and the floor carries their weight; from 2 to 4 s",
            .errors = {{"overlap", "largest overlap, over the radius"},
                       {"force", "mean force on the floor over the weight, less 1"}},
            .solvers = {"impulse", "soft", "pairwise"},
            .steps = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960},
            .counts = true,
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

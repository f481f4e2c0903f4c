#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kBalls = 5, kMoving = 2;
constexpr double kGap = 0.05, kSpeed = 2, kTime = 1;  // m, m/s, s

Scene scene_of(int) {
    Scene scene;
    double x = 0;
    for (int i = 0; i < kBalls; ++i) {
        scene.add(disc(0.5, 1, {x, 0}, {i < kMoving ? kSpeed : 0.0, 0}, bouncy(1)));
        x += 1 + kGap + (i + 1 == kMoving ? 0.3 : 0);
    }
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    double largest = 0;
    for (int i = 0; i < kBalls; ++i) {
        const double exact = i >= kBalls - kMoving ? kSpeed : 0;
        largest = std::max(largest, std::abs(stepper.state(static_cast<std::size_t>(i)).velocity.x - exact));
    }
    return {largest / kSpeed};
}

}  // namespace

Case newtons_cradle() {
    return {.id = "A17",
            .title = "Newton's cradle: two balls come, two leave",
            .kind = "single impacts",
            .effects = "N R",
            .exact = "the last two leave with the first two's speed, the rest stand",
            .errors = {{"velocity", "largest difference in velocity, over the first balls'"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = {1.0 / 10, 1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480},
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

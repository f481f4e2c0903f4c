#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kHeight = 1, kLow = 0.5, kHigh = 0.2, kLight = 0.1, kGap = 0.05;  // m, m, m, kg, m
constexpr double kTime = 0.6;                                                      // s

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_of(bouncy(1));
    scene.add(disc(kLow, 1, {0, kHeight + kLow}, {}, bouncy(1)));
    scene.add(disc(kHigh, kLight, {0, kHeight + 2 * kLow + kGap + kHigh}, {}, bouncy(1)));
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    // The heavy ball turns round at v, then both approach at 2 v until the gap is closed.
    const double v = std::sqrt(2 * kGravity * kHeight), wait = kGap / (2 * v), mass = 1 + kLight;
    const double up = v - kGravity * wait, down = -v - kGravity * wait;
    const double low = ((1 - kLight) * up + 2 * kLight * down) / mass;
    const double high = ((kLight - 1) * down + 2 * up) / mass;
    const double since = kTime - v / kGravity - wait;
    const double error_low = stepper.state(0).velocity.y - (low - kGravity * since);
    const double error_high = stepper.state(1).velocity.y - (high - kGravity * since);
    return {std::max(std::abs(error_low), std::abs(error_high)) / v};
}

}  // namespace

Case galilean_cannon() {
    return {
        .id = "A18",
        .title = "Galilean cannon: a light ball on a heavy one",
        .kind = "bouncing under gravity",
        .effects = "G N R",
        .exact =
            "thrown up with (3M - m)/(M + m) of the speed they fall with, put right for the gap between them",
        .errors = {{"velocity", "larger difference in velocity, over the speed they fall with"}},
        .solvers = {"event", "impulse", "soft", "pairwise"},
        .steps = steps_of_frames(),
        .scene = scene_of,
        .run = run};
}

}  // namespace carom::accuracy

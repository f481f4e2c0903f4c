#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kHeight = 1, kRestitution = 0.8, kRadius = 0.1;  // m, 1, m
constexpr double kLastLook = 3.4;                                 // s; after ten bounces, before it rests

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_of(bouncy(kRestitution));
    scene.add(disc(kRadius, 1, {0, kHeight + kRadius}, {}, bouncy(kRestitution)));
    return scene;
}

/// Height above the floor: a fall, then parabolas of e times the speed each.
double exact_height(double time) {
    double speed = std::sqrt(2 * kGravity * kHeight);
    double since = time - speed / kGravity;
    if (since < 0) return kHeight - 0.5 * kGravity * time * time;
    for (speed *= kRestitution; since > 2 * speed / kGravity; speed *= kRestitution)
        since -= 2 * speed / kGravity;
    return since * (speed - 0.5 * kGravity * since);
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    double largest = 0, rms_sum = 0;
    int looks = 0;
    for (int i = 1; 0.1 * i <= kLastLook; ++i, ++looks) {
        stepper.advance_to(0.1 * i);
        const double error = stepper.state(0).position.y - kRadius - exact_height(0.1 * i);
        largest = std::max(largest, std::abs(error)), rms_sum += error * error;
    }
    return {std::sqrt(rms_sum / looks) / kHeight, largest / kHeight};
}

}  // namespace

Case bouncing_ball() {
    return {.id = "A4",
            .title = "Ball dropped from 1 m, restitution 0.8",
            .kind = "bouncing under gravity",
            .effects = "G N R",
            .exact = "parabolas, each bounce with 0.8 times the speed; looked at every 0.1 s up to 3.4 s",
            .errors = {{"height (rms)", "root mean square difference in height, over the first height"},
                       {"height (largest)", "largest difference in height, over the first height"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

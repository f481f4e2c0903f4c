#include "accuracy/cases/parts.hpp"
#include "accuracy/galperin.hpp"

namespace carom::accuracy {
namespace {

constexpr double kRatio = 1e4, kTime = 30;  // masses 1 and 100²; s
constexpr std::int64_t kCollisions = 314;   // floor(100 pi)

Scene scene_of(int) {
    return galperin_scene(kRatio);
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double impacts = count_impacts(stepper, true);
    return {stepper.state(1).velocity.x - galperin_velocity(kRatio, kCollisions), impacts / kCollisions - 1};
}

}  // namespace

Case galperin_billiard() {
    return {.id = "A16",
            .title = "Galperin's billiard: a wall, a mass, one 10,000 times as heavy",
            .kind = "single impacts",
            .effects = "N R",
            .exact = "exactly floor(100 pi) = 314 collisions",
            .errors = {{"velocity", "difference of the heavy disc's last velocity, over its first"},
                       {"collisions", "difference in their number, over 314"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480, 1.0 / 960},
            .counts = true,
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

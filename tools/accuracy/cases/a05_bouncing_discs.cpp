#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kDiscs = 49;
constexpr double kHeight = 5, kRadius = 0.1, kTime = 20;  // m, m, s

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_of(bouncy(1));
    for (int i = 0; i < kDiscs; ++i) scene.add(disc(kRadius, 1, {1.0 * i, kHeight + kRadius}, {}, bouncy(1)));
    return scene;
}

double exact_height(double time) {
    const double fall = std::sqrt(2 * kHeight / kGravity);
    const double since_top = std::abs(std::remainder(time, 2 * fall));
    return kHeight - 0.5 * kGravity * since_top * since_top;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    const double floor = kDiscs * kGravity * kRadius, start = stepper.energy() - floor;
    RootMeanSquare energy, height;
    for (int i = 1; 0.1 * i <= kTime + 1e-9; ++i) {
        stepper.advance_to(0.1 * i);
        energy.add((stepper.energy() - floor) / start - 1);
        for (std::size_t body = 0; body < kDiscs; ++body)
            height.add((stepper.state(body).position.y - kRadius - exact_height(0.1 * i)) / kHeight);
    }
    return {energy.value(), height.value()};
}

}  // namespace

Case bouncing_discs() {
    return {.id = "A5",
            .title = "49 discs bouncing from 5 m, restitution 1",
            .kind = "bouncing under gravity",
            .effects = "G N R",
            .exact = "energy constant, parabolas of one period; looked at every 0.1 s for 20 s",
            .errors = {{"energy", "root mean square change of the energy above the floor, over the first"},
                       {"height", "root mean square difference in height, over the first height"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = {0.02, 0.01, 0.005, 0.002, 0.001},
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kSpin = 13, kTime = 100;  // rad/s, s

Scene scene_of(int) {
    Scene scene;
    scene.add(disc(0.5, 1, {0, 0}, {}, {}));
    scene.bodies[0].angular_velocity = kSpin;
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    // Angles are compared within a whole turn: some engines keep them so.
    const double off = std::remainder(stepper.state(0).angle - kSpin * kTime, 2 * std::numbers::pi);
    return {off / (kSpin * kTime), stepper.state(0).angular_velocity / kSpin - 1};
}

}  // namespace

Case free_spin() {
    return {.id = "A36",
            .title = "A disc spins freely with 13 rad/s for 100 s",
            .kind = "free flight",
            .effects = "W",
            .exact = "angle = ω t, and the spin stays",
            .errors = {{"angle", "difference in angle, over the angle turned"},
                       {"spin", "spin over the first, less 1"}},
            .solvers = {"event", "impulse", "soft", "rattle"},
            .note = "Angles are sums: in single precision every step rounds them.",
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

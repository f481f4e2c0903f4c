#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kTime = 2;  // s
constexpr Vec2 kVelocity{3, 9};

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(disc(0.5, 1, {}, kVelocity, bouncy(1)));
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const Vec2 exact{kVelocity.x * kTime, kVelocity.y * kTime - 0.5 * kGravity * kTime * kTime};
    const Vec2 x = stepper.state(0).position;
    const double fall = 0.5 * kGravity * kTime * kTime;
    return {std::hypot(x.x - exact.x, x.y - exact.y) / fall};
}

}  // namespace

Case projectile() {
    return {.id = "A1",
            .title = "Projectile",
            .kind = "free flight",
            .effects = "G",
            .exact = "x = x0 + v0 t + g t²/2, at 2 s",
            .errors = {{"position", "distance from the exact place, over the fall g t²/2"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

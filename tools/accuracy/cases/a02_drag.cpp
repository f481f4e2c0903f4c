#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kTime = 2, kDrag = 0.7;  // s, 1/s
constexpr Vec2 kVelocity{30, 9};

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.drag.linear = kDrag;
    scene.add(disc(0.5, 1, {}, kVelocity, bouncy(1)));
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double left = std::exp(-kDrag * kTime), s = (1 - left) / kDrag, q = (kTime - s) / kDrag;
    const Vec2 position{kVelocity.x * s, kVelocity.y * s - kGravity * q};
    const Vec2 velocity{kVelocity.x * left, kVelocity.y * left - kGravity * s};
    const BodyState state = stepper.state(0);
    return {std::hypot(state.position.x - position.x, state.position.y - position.y) /
                std::hypot(position.x, position.y),
            std::hypot(state.velocity.x - velocity.x, state.velocity.y - velocity.y) /
                std::hypot(velocity.x, velocity.y)};
}

}  // namespace

Case projectile_with_drag() {
    return {.id = "A2",
            .title = "Projectile with linear drag",
            .kind = "free flight",
            .effects = "G D",
            .exact = "v = v0 exp(-k t) + g (1 - exp(-k t))/k and its integral, at 2 s",
            .errors = {{"position", "distance from the exact place, over the way"},
                       {"velocity", "difference from the exact velocity, over its size"}},
            .solvers = {"impulse", "soft", "pairwise"},
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

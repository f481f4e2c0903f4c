#include <algorithm>

#include "accuracy/cases/parts.hpp"

// There are no forces to pull the box with, so gravity is tilted: in the frame that falls along with it the
// pull is zero, and everything has its acceleration on top.

namespace carom::accuracy {
namespace {

constexpr int kDiscs = 25;
constexpr double kBoxMass = 10, kDiscMass = 1, kAlong = 9;  // kg, kg, m/s²
constexpr double kOnGround = 0.4, kOnBox = 0.8;             // coefficients of friction
constexpr double kTime = 0.5;                               // s

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {kAlong, -kGravity};
    scene.add(ground(-40, 40, kOnGround));
    scene.add(box(20, 1, {0, 0.5}, 0, kOnGround));
    scene.bodies.back().mass = kBoxMass;
    // A pair has the geometric mean of both coefficients.
    for (int i = 0; i < kDiscs; ++i)
        scene.add(disc(0.1, kDiscMass, {-9 + 0.6 * i, 1.1}, {}, bouncy(0, kOnBox * kOnBox / kOnGround)));
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double weight = (kBoxMass + kDiscs * kDiscMass) * kGravity;
    const double on_disc = -kOnGround * weight / kBoxMass / (3 / kDiscMass + kDiscs / kBoxMass);
    const double of_box = kAlong + 3 * on_disc / kDiscMass, of_discs = kAlong + on_disc / kDiscMass;
    double discs = 0;
    for (std::size_t i = 0; i < kDiscs; ++i)
        discs = std::max(discs, std::abs(stepper.state(2 + i).velocity.x / (of_discs * kTime) - 1));
    return {stepper.state(1).velocity.x / (of_box * kTime) - 1, discs};
}

}  // namespace

Case pulled_box() {
    return {.id = "A8",
            .title = "A box on the ground is drawn from under 25 discs",
            .kind = "friction",
            .effects = "G N F W",
            .exact =
                "the discs roll: a box with g_x + 3 f/m, discs with g_x + f/m, f = -μ (M + n m) g/M/(3/m + "
                "n/M); velocities after 0.5 s",
            .errors = {{"box", "velocity of the box over the exact one, less 1"},
                       {"discs", "the same of the discs, the largest"}},
            .solvers = {"soft"},
            .steps = steps_of_structures(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

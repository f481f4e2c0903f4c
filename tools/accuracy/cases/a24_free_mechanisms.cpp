#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kRod = 1, kLook = 0.1;          // m, s
constexpr double kPairTime = 2, kStep = 2e-4;    // s, the second of the reference
constexpr double kSpin = 5, kDumbbellTime = 10;  // rad/s, s

Scene double_pendulum_scene(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const BodyId pin = scene.add(pivot({0, 0}));
    const BodyId upper = scene.add(bob({kRod, 0}, 1)), lower = scene.add(bob({2 * kRod, 0}, 1));
    scene.add(Joint{.a = pin, .b = upper, .kind = DistanceJoint{}});
    scene.add(Joint{.a = upper, .b = lower, .kind = DistanceJoint{}});
    return scene;
}

/// Two equal masses on equal rods; y: angles from below, then their rates.
std::array<double, 4> rate_of_pair(const std::array<double, 4>& y) {
    const double a = y[0], b = y[1], va = y[2], vb = y[3], g = kGravity / kRod, d = a - b;
    const double divisor = 3 - std::cos(2 * d);
    return {va, vb,
            (-3 * g * std::sin(a) - g * std::sin(a - 2 * b) -
             2 * std::sin(d) * (vb * vb + va * va * std::cos(d))) /
                divisor,
            2 * std::sin(d) * (2 * va * va + 2 * g * std::cos(a) + vb * vb * std::cos(d)) / divisor};
}

std::vector<double> run_pair(Stepper& stepper, const Scene&, int) {
    std::array<double, 4> y{std::numbers::pi / 2, std::numbers::pi / 2, 0, 0};
    const double start = stepper.energy();
    double place = 0, energy = 0;
    for (int look = 1; kLook * look <= kPairTime + 1e-9; ++look) {
        stepper.advance_to(kLook * look);
        integrate(y, kLook, kStep, rate_of_pair);
        const Vec2 exact{kRod * (std::sin(y[0]) + std::sin(y[1])), -kRod * (std::cos(y[0]) + std::cos(y[1]))};
        place = std::max(place, distance(stepper.state(2).position, exact) / (2 * kRod));
        energy = std::max(energy, std::abs(stepper.energy() - start) / (2 * kGravity * kRod));
    }
    return {place, energy};
}

Scene dumbbell_scene(int) {
    Scene scene;
    const BodyId a = scene.add(bob({-0.5 * kRod, 0}, 1)), b = scene.add(bob({0.5 * kRod, 0}, 1));
    scene.bodies[0].velocity = {0, -0.5 * kSpin * kRod}, scene.bodies[1].velocity = {0, 0.5 * kSpin * kRod};
    scene.add(Joint{.a = a, .b = b, .kind = DistanceJoint{}});
    return scene;
}

std::vector<double> run_dumbbell(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kDumbbellTime);
    const Vec2 a = stepper.state(0).position, b = stepper.state(1).position;
    const double turned = kSpin * kDumbbellTime;
    const double off = std::remainder(std::atan2(b.y - a.y, b.x - a.x) - turned, 2 * std::numbers::pi);
    const double energy = 0.25 * kSpin * kSpin * kRod * kRod;
    const Vec2 force = stepper.simulation().joint_force(0);
    return {off / turned, stepper.kinetic_energy() / energy - 1,
            std::hypot(force.x, force.y) / (0.5 * kSpin * kSpin * kRod) - 1};
}

}  // namespace

Case double_pendulum() {
    return {.id = "A24",
            .title = "A double pendulum of rods, let go level",
            .kind = "mechanisms",
            .effects = "G J",
            .exact =
                "Lagrange's equations of the two angles (Runge and Kutta, 0.2 ms); energy is kept; looked at "
                "every 0.1 s up to 2 s",
            .errors = {{"place", "largest distance of the lower end from the exact place, over both rods"},
                       {"energy", "largest difference in energy, over 2 m g l"}},
            .solvers = {"soft", "rattle"},
            .steps = steps_of_frames(),
            .scene = double_pendulum_scene,
            .run = run_pair};
}

Case dumbbell() {
    return {.id = "A24-dumbbell",
            .title = "Two masses on a rod, free, turning with 5 rad/s",
            .kind = "mechanisms",
            .effects = "J",
            .exact = "spin and energy are kept, the rod draws with m ω² l/2; after 10 s, 8 turns",
            .errors = {{"angle", "difference in angle, over the angle turned"},
                       {"energy", "energy over the first, less 1"},
                       {"tension", "force of the rod, mean of a step, over the exact one, less 1"}},
            .solvers = {"soft", "rattle"},
            .steps = steps_of_frames(),
            .scene = dumbbell_scene,
            .run = run_dumbbell};
}

}  // namespace carom::accuracy

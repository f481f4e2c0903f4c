#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kWedge = 2, kBlock = 3;                // kg
constexpr double kWidth = 4, kHeight = 2, kSide = 0.2;  // m
constexpr double kTime = 0.5;                           // s
const double kSlope = std::atan(kHeight / kWidth);

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(ground(-40, 40, 0));
    scene.add(box(1, 1, {kWidth / 3, kHeight / 3}, 0, 0));
    scene.bodies.back().shape = Polygon{{{0, 0}, {kWidth, 0}, {0, kHeight}}};
    scene.bodies.back().mass = kWedge;
    const double s = std::sin(kSlope), c = std::cos(kSlope);
    scene.add(
        box(kSide, kSide, {1 + 0.5 * kSide * s, kHeight * (1 - 1 / kWidth) + 0.5 * kSide * c}, -kSlope, 0));
    scene.bodies.back().mass = kBlock;
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    stepper.advance_to(kTime);
    const double s = std::sin(kSlope), c = std::cos(kSlope);
    const double wedge = -kBlock * kGravity * s * c / (kWedge + kBlock * s * s) * kTime;
    return {stepper.state(1).velocity.x / wedge - 1,
            -stepper.state(2).velocity.x * kBlock / (kWedge * wedge) - 1};
}

}  // namespace

Case wedge() {
    return {.id = "A25",
            .title = "A block slides down a free wedge, all without friction",
            .kind = "friction",
            .effects = "G N",
            .exact = "the wedge is driven back with m g sin cos/(M + m sin²); velocities after 0.5 s",
            .errors = {{"wedge", "velocity of the wedge over the exact one, less 1"},
                       {"block", "level velocity of the block over the exact one, less 1"}},
            .solvers = {"soft"},
            .steps = steps_of_structures(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

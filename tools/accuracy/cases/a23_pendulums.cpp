#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr std::array<double, 3> kDegrees{90, 120, 170};
constexpr double kRod = 1, kApart = 4, kTime = 10, kLook = 0.1, kStep = 5e-4;  // m, m, s

double first_angle(std::size_t pendulum) {
    return kDegrees[pendulum] * std::numbers::pi / 180;
}

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    for (std::size_t i = 0; i < kDegrees.size(); ++i) {
        const double x = kApart * static_cast<double>(i), angle = first_angle(i);
        const BodyId pin = scene.add(pivot({x, 0}));
        const BodyId end = scene.add(bob({x + kRod * std::sin(angle), -kRod * std::cos(angle)}, 1));
        scene.add(Joint{.a = pin, .b = end, .kind = DistanceJoint{}});
    }
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene&, int) {
    const auto rate = [](const std::array<double, 2>& y) {
        return std::array<double, 2>{y[1], -kGravity / kRod * std::sin(y[0])};
    };
    std::array<std::array<double, 2>, kDegrees.size()> exact{};
    for (std::size_t i = 0; i < exact.size(); ++i) exact[i][0] = first_angle(i);
    const double start = stepper.energy();
    double angle = 0, energy = 0;
    for (int look = 1; kLook * look <= kTime + 1e-9; ++look) {
        stepper.advance_to(kLook * look);
        for (std::size_t i = 0; i < exact.size(); ++i) {
            integrate(exact[i], kLook, kStep, rate);
            const Vec2 at = stepper.state(2 * i + 1).position;
            const double now = std::atan2(at.x - kApart * static_cast<double>(i), -at.y);
            const double off = std::remainder(now - exact[i][0], 2 * std::numbers::pi);
            angle = std::max(angle, std::abs(off) / first_angle(i));
        }
        energy = std::max(energy, std::abs(stepper.energy() - start) / (kGravity * kRod));
    }
    return {angle, energy};
}

}  // namespace

Case pendulums() {
    return {.id = "A23",
            .title = "Rod pendulums from 90°, 120° and 170°",
            .kind = "mechanisms",
            .effects = "G J",
            .exact =
                "θ'' = -g/l sin θ (Runge and Kutta, 0.5 ms), whose period is (2/π) K(sin θ0/2) times that of "
                "small angles; energy is kept; looked at every 0.1 s up to 10 s",
            .errors = {{"angle", "largest difference in angle, over the first angle"},
                       {"energy", "largest difference in the energy of all three, over m g l"}},
            .solvers = {"soft", "rattle"},
            .steps = steps_of_frames(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

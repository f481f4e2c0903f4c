#include <algorithm>
#include <optional>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kLength = 1, kPulled = 0.25, kTime = 2;         // m, m, s
constexpr double kFrequency = 3, kRatio = 0.2;                   // Hz, no unit
constexpr int kInLine = 10;                                      // masses
constexpr double kLineTime = 10, kAmplitude = 0.5, kLook = 0.1;  // s, m, s

/// A mass of 1 kg on a spring along x, pulled and let go.
void add_spring(Scene& scene, double y, double ratio) {
    const BodyId pin = scene.add(pivot({0, y}));
    const BodyId mass = scene.add(bob({kLength + kPulled, y}, 1));
    scene.add(
        Joint{.a = pin,
              .b = mass,
              .kind = DistanceJoint{.length = kLength, .frequency = kFrequency, .damping_ratio = ratio}});
}

Scene two_springs(int) {
    Scene scene;
    add_spring(scene, 0, 0), add_spring(scene, 2, kRatio);
    return scene;
}

/// Displacement of a damped oscillator that starts at 1 at rest.
double oscillation(double ratio, double time) {
    const double w = 2 * kPi * kFrequency, damped = w * std::sqrt(1 - ratio * ratio);
    return std::exp(-ratio * w * time) *
           (std::cos(damped * time) + ratio * w / damped * std::sin(damped * time));
}

std::vector<double> run_two(Stepper& stepper, const Scene&, int) {
    double undamped = 0, damped = 0;
    for (int i = 1; kLook * i <= kTime + 1e-9; ++i) {
        stepper.advance_to(kLook * i);
        const auto error = [&](std::size_t body, double ratio) {
            return std::abs((stepper.state(body).position.x - kLength) / kPulled -
                            oscillation(ratio, kLook * i));
        };
        undamped = std::max(undamped, error(1, 0)), damped = std::max(damped, error(3, kRatio));
    }
    return {undamped, damped};
}

/// The lowest mode of masses of 1 kg in line on springs, the first on a pin.
double mode(int mass) {
    return std::sin((mass + 1) * kPi / (2 * kInLine + 1));
}

Scene springs_in_line(int) {
    Scene scene;
    BodyId last = scene.add(pivot({0, 0}));
    for (int i = 0; i < kInLine; ++i) {
        const BodyId next = scene.add(bob({(i + 1) * kLength + kAmplitude * mode(i) / kInLine, 0}, 1));
        // The mass that swings between two of 1 kg is 1/2 kg.
        const double frequency = kFrequency * (i > 0 ? std::sqrt(2.0) : 1);
        scene.add(
            Joint{.a = last, .b = next, .kind = DistanceJoint{.length = kLength, .frequency = frequency}});
        last = next;
    }
    return scene;
}

std::vector<double> run_line(Stepper& stepper, const Scene&, int) {
    const double w = 2 * 2 * kPi * kFrequency * std::sin(kPi / (2 * (2 * kInLine + 1)));
    double largest = 0;
    for (int i = 1; kLook * i <= kLineTime + 1e-9; ++i) {
        stepper.advance_to(kLook * i);
        for (int mass = 0; mass < kInLine; ++mass) {
            const double x = stepper.state(static_cast<std::size_t>(1 + mass)).position.x;
            const double exact = kAmplitude * mode(mass) / kInLine * std::cos(w * kLook * i);
            largest = std::max(largest, std::abs(x - (mass + 1) * kLength - exact));
        }
    }
    return {largest * kInLine / kAmplitude};
}

}  // namespace

Case springs() {
    return {.id = "A3",
            .title = "Masses on springs, undamped and with a damping ratio of 0.2",
            .kind = "mechanisms",
            .effects = "J",
            .exact =
                "x = exp(-ζ ω t) (cos(ω_d t) + ζ ω/ω_d sin(ω_d t)), ω_d = ω sqrt(1 - ζ²), ω = 2 π 3 Hz; "
                "looked at every 0.1 s up to 2 s",
            .errors = {{"damped", "largest difference in displacement of the damped one, over the first"},
                       {"undamped", "the same of the undamped one"}},
            .solvers = {"soft", "rattle"},
            .note = "A spring alone is solved by the exact flow of its step, so what is left is round-off.",
            .steps = steps_of_frames(),
            .scene = two_springs,
            .run = [](Stepper& stepper, const Scene& scene, int member) {
                const std::vector<double> errors = run_two(stepper, scene, member);
                return std::vector<double>{errors[1], errors[0]};
            }};
}

Case springs_on_springs() {
    return {.id = "A3-line",
            .title = "Ten masses in line on springs, in their lowest mode",
            .kind = "mechanisms",
            .effects = "J",
            .exact =
                "x_k = sin(k π/21) cos(ω t), ω = 2 ω0 sin(π/42), ω0 = 2 π 3 Hz; looked at every 0.1 s up to "
                "10 s, 4.5 periods",
            .errors = {{"displacement", "largest difference in displacement, over the largest"}},
            .solvers = {"soft", "rattle"},
            .steps = steps_of_frames(),
            .scene = springs_in_line,
            .run = run_line};
}

}  // namespace carom::accuracy

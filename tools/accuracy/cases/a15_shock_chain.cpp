#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kBodies = 12;
constexpr double kRatio = 0.8, kRestitution = 0.9, kTime = 3;  // 1, 1, s

Scene scene_of(int) {
    Scene scene;
    double mass = 1;
    for (int i = 0; i < kBodies; ++i, mass *= kRatio)
        scene.add(disc(0.5, mass, {1.1 * i, 0}, {i == 0 ? 1.0 : 0.0, 0}, bouncy(kRestitution)));
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene& scene, int) {
    stepper.advance_to(kTime);
    double largest = 0, incoming = 1;
    for (std::size_t i = 0; i < kBodies; ++i) {
        double exact = incoming;
        if (i + 1 < kBodies) {
            const double m1 = *scene.bodies[i].mass, m2 = *scene.bodies[i + 1].mass;
            exact = (m1 - kRestitution * m2) * incoming / (m1 + m2);
            incoming *= (1 + kRestitution) * m1 / (m1 + m2);
        }
        largest = std::max(largest, std::abs(stepper.state(i).velocity.x - exact));
    }
    return {largest};
}

}  // namespace

Case shock_chain() {
    return {.id = "A15",
            .title = "A shock runs down twelve discs, each lighter than the one before",
            .kind = "single impacts",
            .effects = "N R",
            .exact = "v1' = ((m1 - e m2) v1 + (1 + e) m2 v2)/(m1 + m2), pair after pair",
            .errors = {{"velocity", "largest difference in velocity, over the first disc's"}},
            .solvers = {"event", "impulse", "soft", "pairwise"},
            .steps = {1.0 / 10, 1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240, 1.0 / 480},
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

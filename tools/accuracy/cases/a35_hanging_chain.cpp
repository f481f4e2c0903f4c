#include <algorithm>

#include "accuracy/cases/parts.hpp"

namespace carom::accuracy {
namespace {

constexpr int kLinks = 40;
constexpr double kLink = 1, kWeight = 1000, kTime = 4;  // m, times a link's mass, s

/// A disc whose inertia is that of a rod: radius l/sqrt(6).
Body rod(double y, double mass) {
    return bob({0, y}, mass, kLink / std::sqrt(6.0));
}

Scene scene_of(int) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    BodyId last = scene.add(pivot({0, 0}));
    for (int i = 0; i <= kLinks; ++i) {
        const BodyId next = scene.add(rod(-(i + 0.5) * kLink, i < kLinks ? 1 : kWeight));
        scene.add(Joint{.a = last, .b = next, .kind = RevoluteJoint{.anchor = Vec2{0, -i * kLink}}});
        last = next;
    }
    return scene;
}

std::vector<double> run(Stepper& stepper, const Scene& scene, int) {
    stepper.advance_to(kTime);
    double stretch = 0, tension = 0;
    for (int i = 0; i <= kLinks; ++i) {
        const auto body = static_cast<std::size_t>(i + 1);
        const double sunk = scene.bodies[body].position.y - stepper.state(body).position.y,
                     above =
                         i > 0 ? scene.bodies[body - 1].position.y - stepper.state(body - 1).position.y : 0;
        stretch = std::max(stretch, std::abs(sunk - above) / kLink);
        const double below = kGravity * (kLinks - i + kWeight);
        const double error =
            std::abs(stepper.simulation().joint_force(static_cast<std::size_t>(i)).y / below - 1);
        tension = std::isnan(error) ? error : std::max(tension, error);
    }
    return {stretch, tension};
}

}  // namespace

Case hanging_chain() {
    return {.id = "A35",
            .title = "A chain of 40 links with a weight of 1,000 links",
            .kind = "mechanisms",
            .effects = "G J",
            .exact = "no joint opens, and each carries the weight below it; after 4 s",
            .errors = {{"stretch", "largest gap of a joint, over a link"},
                       {"tension",
                        "largest difference of a joint's force from the weight below, over that weight"}},
            .solvers = {"soft", "rattle"},
            .steps = steps_of_structures(),
            .scene = scene_of,
            .run = run};
}

}  // namespace carom::accuracy

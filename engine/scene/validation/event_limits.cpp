#include "scene/validation/event_limits.hpp"

#include <algorithm>

#include "scene/validation/wording.hpp"

namespace carom {
namespace {

/// The least restitution of what can hold a body up; above 1 if nothing can.
double smallest_support(const Scene& scene) {
    double smallest = 2;
    if (const auto& walls = scene.walls;
        walls && (walls->left || walls->right || walls->bottom || walls->top))
        smallest = walls->material.restitution;
    for (const Body& body : scene.bodies)
        if (body.type != BodyType::dynamic_body) smallest = std::min(smallest, body.material.restitution);
    return smallest;
}

std::optional<Problem> find_resting_problem(const Scene& scene) {
    if (scene.gravity == Vec2{}) return std::nullopt;
    const double support = smallest_support(scene);
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        const double restitution = std::max(body.material.restitution, support);
        if (body.type != BodyType::dynamic_body || restitution >= kSmallestEventRestitution) continue;
        const Item item{"body", "/bodies", static_cast<std::ptrdiff_t>(i), body.name};
        return problem(
            ErrorCode::inconsistent, item, "/material/restitution", "restitution ", restitution,
            " on what holds it up under gravity, so it comes to rest at once; the solver \"event\" holds "
            "nothing at rest. Use \"auto\" or \"impulse\", or a restitution of at least ",
            kSmallestEventRestitution, ".");
    }
    return std::nullopt;
}

}  // namespace

std::optional<Problem> find_event_problem(const Scene& scene) {
    static constexpr Item kDrag{"the drag has", "/drag", -1, ""};
    if (scene.drag.linear != 0 || scene.drag.angular != 0)
        return problem(
            ErrorCode::inconsistent, kDrag, "/linear", "drag ", scene.drag.linear, " 1/s (linear) and ",
            scene.drag.angular,
            " 1/s (angular); the solver \"event\" knows free flight only. Use \"auto\" or \"impulse\", or "
            "set them to 0.");
    return find_resting_problem(scene);
}

}  // namespace carom

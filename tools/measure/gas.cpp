#include "measure/gas.hpp"

#include <carom/generators.hpp>

#include <cmath>
#include <numbers>

namespace carom::measure {
namespace {

constexpr int kStepsToForget = 60;

}  // namespace

Scene gas_scene(std::int64_t bodies) {
    constexpr double kDiscArea = std::numbers::pi * kGasRadius * kGasRadius;  // m²
    const double side = std::sqrt(static_cast<double>(bodies) * kDiscArea / kGasPacking);
    Scene scene;
    scene.walls.emplace();
    scene.walls->max = {side, side};
    scene.walls->material.restitution = 1;
    Gas gas;
    gas.count = bodies;
    gas.radius = {kGasRadius, kGasRadius};
    gas.velocity_rms = kGasSpeed;
    gas.body.material.restitution = 1;
    add_gas(scene, gas);
    return scene;
}

Scene flown_gas_scene(std::int64_t bodies) {
    Scene scene = gas_scene(bodies);
    World world(scene);
    for (int i = 0; i < kStepsToForget; ++i) world.step(kStep);
    const auto view = world.bodies();
    for (std::size_t row = 0; row < view.count; ++row) {
        Body& body = scene.bodies[view.id[row].index];
        body.position = {view.position_x[row], view.position_y[row]};
        body.velocity = {view.velocity_x[row], view.velocity_y[row]};
    }
    return scene;
}

PairwiseScene pairwise_gas(const Scene& scene) {
    PairwiseScene description;
    description.walls.emplace();
    description.walls->max_x = scene.walls->max.x;
    description.walls->max_y = scene.walls->max.y;
    description.walls->restitution = 1;
    description.restitution = 1;
    for (const Body& body : scene.bodies) {
        PairwiseBody each;
        each.x = body.position.x, each.y = body.position.y;
        each.vx = body.velocity.x, each.vy = body.velocity.y;
        each.mass = std::numbers::pi * kGasRadius * kGasRadius;
        each.radius = kGasRadius;
        description.bodies.push_back(each);
    }
    return description;
}

}  // namespace carom::measure

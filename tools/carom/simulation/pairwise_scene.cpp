#include "simulation/pairwise_scene.hpp"

#include <carom/errors.hpp>

#include <algorithm>
#include <sstream>
#include <string>

#include "simulation/body_mass.hpp"
#include "terminal/format.hpp"

namespace carom::tool {
namespace {

constexpr const char* kRemedy = "Change the scene, or leave the choice of the solver to \"auto\".";

template <class... Parts>
[[noreturn]] void refuse(ErrorCode code, const Parts&... parts) {
    std::ostringstream text;
    text << "Solver pairwise: ";
    (text << ... << parts);
    throw Error(code, text.str());
}

std::string label(const Scene& scene, std::size_t index) {
    const std::string& name = scene.bodies[index].name;
    return name.empty() ? format("body %zu", index) : joined(format("body %zu (\"", index), name, "\")");
}

void check_bodies(const Scene& scene) {
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Body& body = scene.bodies[i];
        if (body.type != BodyType::dynamic_body)
            refuse(ErrorCode::inconsistent, label(scene, i), " is ",
                   body.type == BodyType::static_body ? "static" : "kinematic",
                   "; the naive engine moves every body. ", kRemedy);
        if (!std::holds_alternative<Disc>(body.shape))
            refuse(ErrorCode::inconsistent, label(scene, i),
                   " is not a disc; the naive engine knows discs only. ", kRemedy);
        if (body.material.friction > 0)
            refuse(ErrorCode::inconsistent, label(scene, i), " has friction ", body.material.friction,
                   "; the naive engine has none. ", kRemedy);
        if (body.material.rolling_resistance > 0)
            refuse(ErrorCode::inconsistent, label(scene, i), " has rolling resistance ",
                   body.material.rolling_resistance, "; the naive engine has none. ", kRemedy);
        if (body.material.restitution != scene.bodies[0].material.restitution)
            refuse(ErrorCode::inconsistent, label(scene, i), " has restitution ", body.material.restitution,
                   " and body 0 has ", scene.bodies[0].material.restitution,
                   "; the naive engine takes one for all bodies. ", kRemedy);
    }
}

/// What `Scene::validate` lets pass, because other solvers can do it.
void check_settings(const Scene& scene) {
    if (scene.effects.continuous == true)
        refuse(ErrorCode::inconsistent, "effect continuous is forced on; the naive engine does not have it. ",
               kRemedy);
}

PairwiseWalls to_pairwise_walls(const Walls& walls, double body_restitution) {
    return {.min_x = walls.min.x,
            .min_y = walls.min.y,
            .max_x = walls.max.x,
            .max_y = walls.max.y,
            .left = walls.left,
            .right = walls.right,
            .bottom = walls.bottom,
            .top = walls.top,
            .restitution = std::max(walls.material.restitution, body_restitution)};
}

}  // namespace

PairwiseScene to_pairwise(const Scene& scene) {
    check_bodies(scene);
    check_settings(scene);
    PairwiseScene converted;
    converted.gravity_x = scene.gravity.x;
    converted.gravity_y = scene.gravity.y;
    converted.linear_drag = scene.drag.linear;
    converted.angular_drag = scene.drag.angular;
    converted.restitution = scene.bodies.empty() ? 0 : scene.bodies[0].material.restitution;
    if (scene.walls) converted.walls = to_pairwise_walls(*scene.walls, converted.restitution);
    for (const Body& body : scene.bodies)
        converted.bodies.push_back({.x = body.position.x,
                                    .y = body.position.y,
                                    .vx = body.velocity.x,
                                    .vy = body.velocity.y,
                                    .mass = mass_of(body),
                                    .radius = std::get<Disc>(body.shape).radius,
                                    .angle = body.angle,
                                    .omega = body.angular_velocity});
    return converted;
}

}  // namespace carom::tool

#pragma once

#include <carom/scene.hpp>

#include <vector>

#include "solvers/event/event_dynamics.hpp"

namespace carom::test {

inline EventLaws event_laws(const Scene& scene) {
    EventLaws laws;
    laws.gravity = scene.gravity;
    if (!scene.walls) return laws;
    const Walls& w = *scene.walls;
    laws.walls = {EventWall{w.left, {1, 0}, w.min.x}, EventWall{w.right, {-1, 0}, -w.max.x},
                  EventWall{w.bottom, {0, 1}, w.min.y}, EventWall{w.top, {0, -1}, -w.max.y}};
    laws.wall_restitution = w.material.restitution;
    laws.wall_friction = w.material.friction;
    return laws;
}

/// The bodies of a scene as the solver takes them; every dynamic one has a mass of its own.
inline std::vector<EventBody> event_bodies(const Scene& scene) {
    std::vector<EventBody> bodies;
    for (const Body& body : scene.bodies) {
        const double radius = std::get<Disc>(body.shape).radius;
        const bool moves = body.type == BodyType::dynamic_body;
        const double inverse_mass = moves ? 1 / body.mass.value() : 0;
        bodies.push_back({.position = body.position,
                          .velocity = body.velocity,
                          .angle = body.angle,
                          .spin = body.angular_velocity,
                          .radius = radius,
                          .inverse_mass = inverse_mass,
                          .inverse_inertia = 2 * inverse_mass / (radius * radius),
                          .restitution = body.material.restitution,
                          .friction = body.material.friction});
    }
    return bodies;
}

}  // namespace carom::test

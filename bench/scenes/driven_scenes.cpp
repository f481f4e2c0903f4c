#include "scenes/driven_scenes.hpp"

#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

// As the tumbler and the spinner of Box2D's benchmarks, at 2,026 and 3,039 bodies.

namespace carom::bench {
namespace {

constexpr double kGravity = 10;  // m/s²
constexpr int kFalls = 300;      // steps, in which boxes have fallen on each other

/// A body on a hinge at its centre, with a motor.
/// @param holder  has the hinge, and does not touch the body; left out: the world
void add_driven(Scene& scene, std::optional<BodyId> holder, Body body, double speed, double torque) {
    const Vec2 centre = body.position;
    const BodyId id = scene.add(std::move(body));
    scene.add(
        Joint{.a = holder,
              .b = id,
              .kind = RevoluteJoint{.anchor = centre, .motor_speed = speed, .max_motor_torque = torque}});
}

/// What the spinner stirs, a third each.
Shape grain(std::int64_t number) {
    if (number % 3 == 0) return Capsule{.length = 0.5, .radius = 0.25};
    if (number % 3 == 1) return Disc{0.35};
    return Box{0.7, 0.7};
}

}  // namespace

BenchScene driven_drum(std::int64_t bodies) {
    constexpr double kSide = 0.25, kSpacing = 0.4, kFriction = 0.6;  // m, m, no unit
    constexpr double kDensity = 50, kSpeed = 25;                     // kg/m², degrees/s
    const auto across = static_cast<std::int64_t>(std::ceil(std::sqrt(static_cast<double>(bodies - 1))));
    const double half = std::max(2.0, kSpacing / 1.8 * static_cast<double>(across)), wall = 0.1 * half;
    Scene scene;
    scene.gravity = {0, -kGravity};
    Compound drum;
    for (const double side : {-1.0, 1.0}) {
        drum.pieces.push_back({.shape = Box{wall, 2 * half}, .position = {side * half, 0}});
        drum.pieces.push_back({.shape = Box{2 * half, wall}, .position = {0, side * half}});
    }
    add_driven(scene, {}, {.shape = drum, .material = {.density = kDensity, .friction = kFriction}},
               kSpeed * std::numbers::pi / 180, 1e8);
    Lattice boxes;
    boxes.count_x = across, boxes.count_y = across;
    boxes.spacing = {kSpacing, kSpacing};
    boxes.origin = {-0.5 * kSpacing * static_cast<double>(across - 1),
                    -0.5 * kSpacing * static_cast<double>(across - 1)};
    boxes.body.shape = Box{kSide, kSide};
    boxes.body.material.friction = kFriction;
    add_lattice(scene, boxes);
    scene.bodies.resize(static_cast<std::size_t>(bodies));
    return {"driven-drum", std::move(scene), {}, kFalls};
}

BenchScene spinner(std::int64_t bodies) {
    constexpr double kFriction = 0.1, kRestitution = 0.1, kDensity = 0.25;  // kg/m²
    constexpr int kSides = 360;
    // Areas go as the number of bodies: 40 m around 3,038.
    const double radius = std::max(8.0, 40 * std::sqrt(static_cast<double>(bodies) / 3038));
    const double width = 1.2, length = radius, torque = 40'000 * std::pow(radius / 40, 3);
    Scene scene;
    scene.gravity = {0, -kGravity};
    Chain vessel{.loop = true};
    for (int k = 0; k < kSides; ++k) {
        const double angle = -2 * std::numbers::pi * k / kSides;
        vessel.points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    // The vessel holds the bar, so they do not touch: the bar's corners reach beyond it by 5 mm.
    const BodyId holder =
        scene.add({.type = BodyType::static_body, .shape = vessel, .material = {.friction = kFriction}});
    const double low = -0.5 * radius;  // m, of the bar's hinge
    add_driven(scene, holder, {.shape = Box{width, length}, .position = {0, low}}, 5, torque);
    const auto half_row = static_cast<std::int64_t>(0.6 * radius);  // bodies, on either side of the bar
    for (std::int64_t i = 0; i < bodies - 2; ++i) {
        Body body{.shape = grain(i)};
        body.material = {.density = kDensity, .friction = kFriction, .restitution = kRestitution};
        const std::int64_t row = i / (2 * half_row), column = i % (2 * half_row);
        const double side = column < half_row ? -1 : 1;
        body.position = {side * (width + static_cast<double>(column % half_row)),
                         -0.75 * radius + static_cast<double>(row)};
        scene.add(std::move(body));
    }
    return {"spinner", std::move(scene), {}, 0, kFalls};
}

}  // namespace carom::bench

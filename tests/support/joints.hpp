#pragma once

#include <carom/carom.hpp>

#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "torture/hard/joint_scenes.hpp"

namespace carom::test {

using torture::bar;
using torture::weighted_chain;

inline Body bob(Vec2 position, double mass = 1, double radius = 0.1) {
    return {.shape = Disc{radius}, .position = position, .mass = mass, .group = -1};
}

/// A rod of length 1 that hangs from the origin, at an angle from below [rad].
inline Scene rod_pendulum(double angle) {
    Scene scene;
    scene.gravity = {0, -10};
    const BodyId b = scene.add(bob({std::sin(angle), -std::cos(angle)}));
    scene.add(Joint{.b = b, .kind = DistanceJoint{}});
    return scene;
}

/// Discs on a square lattice, joined by rods, row by row from the bottom; the upper corners hang.
inline Scene hanging_net(int count) {
    Scene scene;
    scene.gravity = {0, -10};
    std::vector<BodyId> ids;
    for (int y = 0; y < count; ++y)
        for (int x = 0; x < count; ++x) {
            Body body = bob({double(x), double(y)});
            if (y == count - 1 && (x == 0 || x == count - 1)) body.type = BodyType::static_body;
            ids.push_back(scene.add(body));
        }
    for (int y = 0; y < count; ++y)
        for (int x = 0; x < count; ++x) {
            const auto at = static_cast<std::size_t>(y * count + x);
            if (x + 1 < count) scene.add(Joint{.a = ids[at], .b = ids[at + 1], .kind = DistanceJoint{}});
            if (y + 1 < count)
                scene.add(Joint{
                    .a = ids[at], .b = ids[at + static_cast<std::size_t>(count)], .kind = DistanceJoint{}});
        }
    return scene;
}

/// A joint of every kind, springs, limits, motors, a rope and a loop among them, some over a floor.
inline Scene every_joint() {
    Scene scene;
    scene.gravity = {0, -10};
    const auto add = [&](Vec2 at) {
        return scene.add({.shape = Disc{0.3}, .position = at, .material = {.friction = 0.4}});
    };
    scene.add(
        {.type = BodyType::static_body, .shape = Segment{{-50, 0}, {50, 0}}, .material = {.friction = 0.5}});
    std::vector<BodyId> b;
    for (int i = 0; i < 14; ++i) b.push_back(add({i * 1.0 - 7, 3 + 0.1 * (i % 3)}));
    scene.add(Joint{.b = b[0], .kind = RevoluteJoint{.anchor = Vec2{-8, 3}, .lower = -0.5, .upper = 0.5}});
    scene.add(Joint{.a = b[0],
                    .b = b[1],
                    .kind = RevoluteJoint{.anchor = Vec2{-6.5, 3}, .motor_speed = 2, .max_motor_torque = 3}});
    scene.add(Joint{.b = b[2], .kind = PrismaticJoint{.axis = {1, 1}, .lower = -1, .upper = 0.5}});
    scene.add(Joint{.a = b[2], .b = b[3], .kind = WeldJoint{.frequency = 4, .damping_ratio = 0.2}});
    scene.add(Joint{.a = b[4], .b = b[5], .kind = DistanceJoint{.max = 1.2}});
    scene.add(Joint{.a = b[5], .b = b[6], .kind = DistanceJoint{.frequency = 3, .damping_ratio = 0.1}});
    scene.add(Joint{
        .a = b[7],
        .b = b[8],
        .kind = WheelJoint{.frequency = 4, .damping_ratio = 0.7, .motor_speed = -4, .max_motor_torque = 2}});
    scene.add(Joint{.b = b[9], .kind = TargetJoint{.anchor = {0.1, 0}, .target = {3, 6}, .max_force = 60}});
    for (int i = 10; i < 13; ++i)
        scene.add(Joint{.a = b[std::size_t(i)], .b = b[std::size_t(i + 1)], .kind = DistanceJoint{}});
    scene.add(Joint{.a = b[10], .b = b[12], .kind = DistanceJoint{.anchor_b = {0.1, 0.1}}});
    return scene;
}

}  // namespace carom::test

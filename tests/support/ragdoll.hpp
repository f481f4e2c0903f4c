#pragma once

#include <carom/carom.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>

namespace carom::test {

/// How ragdolls are made.
struct Ragdolls {
    double friction = 0.5;
    double restitution = 0;
    bool has_limits = true;
    bool has_boxes = false;  ///< limbs are boxes instead of capsules
};

/// Eleven limbs on ten hinges, upright when not tilted: hips, chest, head, arms, legs. They do not touch each
/// other. @param hips  m  @param tilt  rad  @param group  below zero, of its own
inline void add_ragdoll(Scene& scene, Vec2 hips, double tilt, std::int32_t group, const Ragdolls& how) {
    struct Limb {
        int on;               // number of the limb that it hangs on; below zero: none
        Vec2 hinge;           // m, from the hips
        double length;        // m, between the centres of the capsule's ends, downwards from the hinge
        double radius;        // m
        double lower, upper;  // rad
    };
    constexpr std::array<Limb, 11> kLimbs{{{-1, {0, 0}, 0.15, 0.11, 0, 0},
                                           {0, {0, 0.12}, -0.30, 0.12, -0.5, 0.5},
                                           {1, {0, 0.52}, -0.08, 0.10, -0.4, 0.4},
                                           {1, {0, 0.40}, 0.24, 0.05, -2.5, 2.5},
                                           {1, {0, 0.40}, 0.24, 0.05, -2.5, 2.5},
                                           {3, {0, 0.12}, 0.24, 0.04, 0, 2.4},
                                           {4, {0, 0.12}, 0.24, 0.04, 0, 2.4},
                                           {0, {0, -0.10}, 0.36, 0.07, -0.6, 1.6},
                                           {0, {0, -0.10}, 0.36, 0.07, -0.6, 1.6},
                                           {7, {0, -0.52}, 0.36, 0.05, -2.3, 0},
                                           {8, {0, -0.52}, 0.36, 0.05, -2.3, 0}}};
    const double c = std::cos(tilt), s = std::sin(tilt);
    const auto place = [&](double x, double y) {
        return Vec2{hips.x + c * x - s * y, hips.y + s * x + c * y};
    };
    std::array<BodyId, kLimbs.size()> ids;
    for (std::size_t i = 0; i < kLimbs.size(); ++i) {
        const Limb& limb = kLimbs[i];
        const double length = std::fabs(limb.length);
        Body body;
        body.shape = Capsule{.length = length, .radius = limb.radius};
        if (how.has_boxes) body.shape = Box{length + limb.radius, 2 * limb.radius};
        body.position = place(limb.hinge.x, limb.hinge.y - (i == 0 ? 0 : limb.length / 2));
        body.angle = tilt - std::numbers::pi / 2;
        body.material = {.friction = how.friction, .restitution = how.restitution};
        body.group = group;
        ids[i] = scene.add(body);
        if (limb.on < 0) continue;
        RevoluteJoint hinge{.anchor = place(limb.hinge.x, limb.hinge.y)};
        if (how.has_limits) hinge.lower = limb.lower, hinge.upper = limb.upper;
        scene.add(Joint{.a = ids[static_cast<std::size_t>(limb.on)], .b = ids[i], .kind = hinge});
    }
}

}  // namespace carom::test

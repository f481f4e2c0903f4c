#pragma once

#include <carom/joints.hpp>
#include <carom/scene.hpp>

#include <cmath>
#include <optional>

namespace carom::torture {

/// A disc whose inertia is that of a rod of this length and mass: rim = length / sqrt(6).
inline Body bar(Vec2 position, double length, double mass = 1) {
    return {.shape = Disc{length / std::sqrt(6.0)}, .position = position, .mass = mass, .group = -1};
}

/// Links of length 1 along a direction from the origin, pinned there, and a weight at the end.
inline Scene weighted_chain(int links, double weight, Vec2 direction) {
    Scene scene;
    scene.gravity = {0, -10};
    std::optional<BodyId> last;
    const auto at = [&](double way) { return Vec2{way * direction.x, way * direction.y}; };
    for (int i = 0; i < links; ++i) {
        const BodyId link = scene.add(bar(at(i + 0.5), 1));
        scene.add(Joint{.a = last, .b = link, .kind = RevoluteJoint{.anchor = at(i)}});
        last = link;
    }
    const BodyId end = scene.add(bar(at(links + 0.5), 1, weight));
    scene.add(Joint{.a = last, .b = end, .kind = RevoluteJoint{.anchor = at(links)}});
    return scene;
}

}  // namespace carom::torture

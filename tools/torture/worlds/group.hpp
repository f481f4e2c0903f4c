#pragma once

#include <carom/scene.hpp>

#include <vector>

namespace carom::torture {

/// Bodies that are put into a world together: one alone, or a mechanism around (0, 0).
struct Group {
    std::vector<Body> bodies;
    std::vector<Joint> joints;  ///< between bodies of the group by their numbers, or with the world

    BodyId add(const Body& body) {
        bodies.push_back(body);
        return {static_cast<std::uint32_t>(bodies.size() - 1), 0};
    }
    JointId add(const Joint& joint) {
        joints.push_back(joint);
        return JointId::of(static_cast<std::uint32_t>(joints.size() - 1));
    }
};

/// m, of the circle around (0, 0) that holds all bodies, and all points of the world that joints hold.
double reach_of(const Group& group);

/// Turns the group about (0, 0), puts (0, 0) at a place, and gives all its bodies that move this velocity.
/// @param angle  rad
Group placed(Group group, Vec2 at, double angle, Vec2 velocity);

/// Appends bodies and joints to the scene.
void add_to(Scene& scene, const Group& group);

}  // namespace carom::torture

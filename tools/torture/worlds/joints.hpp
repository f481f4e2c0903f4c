#pragma once

#include <carom/joints.hpp>

#include <optional>

#include "torture/random.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

/// The two ends of a joint as they stand.
struct JointEnds {
    std::optional<BodyId> a, b;  ///< none: the world
    Vec2 at_a{}, at_b{};         ///< m, their centres, or the point of the world
    double force = 1;            ///< N, of the order of what their weight and motion make
};

/// Holds the two together halfway between their ends: a hinge, a weld, a rod, a rope, a spring; a hinge may
/// have limits, a spring or a motor.
Joint random_link(const JointEnds& ends, const WorldTraits& traits, Random& random);

/// Of any kind but gears; of both bodies free, or b alone.
Joint random_joint(const JointEnds& ends, const WorldTraits& traits, Random& random);

/// A hinge of b at a point of the world, or of a [m].
Joint hinge_at(const JointEnds& ends, Vec2 anchor, const WorldTraits& traits, Random& random);

/// A wheel b on a, with a suspension and, if there are motors, one.
Joint wheel_on(const JointEnds& ends, const WorldTraits& traits, Random& random);

}  // namespace carom::torture

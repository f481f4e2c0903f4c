#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "torture/enclosure.hpp"

namespace carom::torture {

enum class ShapeKind { disc, box, capsule, polygon, compound };

/// What is around the bodies of a random world.
enum class Surroundings {
    closed,  ///< a convex polygon that nothing may leave
    drum,    ///< the same, turning
    floor,   ///< one side of it
    open,    ///< nothing
};

/// What a random world is like; drawn from (seed, index) alone. Lengths, speeds and gravity go with `unit`.
struct WorldTraits {
    std::uint64_t seed = 0, index = 0;
    std::int64_t bodies = 10;  ///< about as many, those of mechanisms among them

    double unit = 1;  ///< m, the middle size: half of a body's longest extent
    std::vector<ShapeKind> shapes{ShapeKind::disc};
    double size_ratio = 1;    ///< largest size over smallest
    double mass_ratio = 0;    ///< largest mass over smallest; 0: masses by density and area
    double density = 1;       ///< kg/m²
    bool is_crowded = false;  ///< bodies are put down without a look at others: many overlap
    double fill = 0.2;        ///< area of the circles around bodies over that of the enclosure

    Material material{};                ///< the most there is of each; density is not used
    bool has_many_materials = false;    ///< each body has some share of it, else all have all of it
    double fixed_share = 0;             ///< of the bodies that are static, segments and chains among them
    double kinematic_share = 0;         ///< of the bodies that move as they are told
    double sensor_share = 0;            ///< of the bodies that are sensors
    double fixed_rotation_share = 0;    ///< of the dynamic bodies
    bool has_filters = false;           ///< bodies have random categories, masks, groups
    double joined_share = 0;            ///< of the bodies that are parts of mechanisms
    bool has_springs = false;           ///< joints that store energy
    bool has_motors = false;            ///< motors, and points that are drawn to a target
    bool are_joints_stretched = false;  ///< rods and ropes start at other lengths than their own
    bool can_break = false;             ///< joints have a largest force

    double gravity = 0;  ///< m/s², downwards
    Drag drag{};
    double speed = 1;  ///< m/s, root mean square at the start, of each body or mechanism
    Surroundings surroundings = Surroundings::closed;
    Fence fence = Fence::walls;
    int sides = 4;          ///< of segments and chains; walls are a box
    double drum_speed = 0;  ///< rad/s

    double dt = 1.0 / 60;  ///< s, the shortest step
    double dt_ratio = 1;   ///< longest step over shortest; above 1 each step has a length of its own
    bool sleeps = false;
    std::optional<int> substeps{}, iterations{};
    Precision precision = Precision::single_;
    bool is_restored = false;  ///< a second world takes over half way, from a saved state
};

/// @param most_bodies  the number of bodies is cut to this, everything else stays
WorldTraits world_traits(std::uint64_t seed, std::uint64_t index, std::int64_t most_bodies);

std::string in_words(const WorldTraits& traits);

}  // namespace carom::torture

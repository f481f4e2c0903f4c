#pragma once

#include <carom/scene.hpp>

#include <cstdint>
#include <string>
#include <vector>

#include "torture/enclosure.hpp"

namespace carom::torture {

/// What a random passive scene is like; drawn from (seed, index) alone.
struct PassiveTraits {
    std::uint64_t seed = 0, index = 0;
    std::int64_t bodies = 10;  ///< of dynamic and static discs and short segments in the enclosure
    double restitution = 0, friction = 0;
    double wall_restitution = 0;
    double fill = 0.5;        ///< of the crowd; of unequal discs what there is room for
    double unit = 1;          ///< m: the smallest radius is half of it
    double radius_ratio = 1;  ///< largest radius over smallest, 1 or 3
    double gravity = 0;       ///< m/s², downwards
    double room = 1;          ///< area of the enclosure over that of the crowd
    double speed = 1;         ///< m/s, root mean square at the start; 0 where the crowd is let go
    double fixed_share = 0;   ///< of the bodies that are static
    double dt = 1.0 / 60;     ///< s
    Fence fence = Fence::walls;
    int sides = 4;  ///< of segments and chains; walls are a box
    Precision precision = Precision::single_;
};

/// @param most_bodies  the number of bodies is cut to this, everything else stays
PassiveTraits passive_traits(std::uint64_t seed, std::uint64_t index, std::int64_t most_bodies);

std::string in_words(const PassiveTraits& traits);

struct PassiveScene {
    Scene scene;
    Enclosure enclosure;
    std::vector<double> lowest;  ///< m, of each body's centre, [bodies]
};

/// Discs do not overlap at the start: they lie on a hexagonal lattice, moved as far as there is room.
PassiveScene passive_scene(const PassiveTraits& traits);

}  // namespace carom::torture

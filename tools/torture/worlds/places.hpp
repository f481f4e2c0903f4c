#pragma once

#include <span>
#include <vector>

#include "torture/enclosure.hpp"
#include "torture/random.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

struct Places {
    Enclosure enclosure;
    std::vector<Vec2> at;  ///< m, centre of each circle
};

/// An enclosure that has room for circles of these radii [m], and a place for each: apart from all others,
/// or in a crowded world anywhere. All of them are inside.
Places places_for(std::span<const double> radii, const WorldTraits& traits, Random& random);

}  // namespace carom::torture

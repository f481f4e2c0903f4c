#pragma once

#include <carom/scene.hpp>

#include <optional>
#include <vector>

#include "torture/enclosure.hpp"
#include "torture/watch.hpp"
#include "torture/worlds/traits.hpp"

namespace carom::torture {

struct RandomWorld {
    Scene scene;
    Enclosure enclosure;
    bool is_closed = true;              ///< nothing may leave the enclosure
    std::optional<std::size_t> drum{};  ///< the body that is the enclosure, where it turns
    std::vector<double> lowest;         ///< m, where the potential energy of each body is 0, [bodies]
    EnergySources sources;
    double least_energy = 0;  ///< J, of all dynamic bodies at a speed of one unit a second
};

/// Everything in it is drawn from the traits alone.
RandomWorld random_world(const WorldTraits& traits);

}  // namespace carom::torture

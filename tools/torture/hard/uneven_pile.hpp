#pragma once

#include <carom/scene.hpp>

#include <cstdint>

namespace carom::torture {

enum class Masses { two, log_uniform };

/// Discs of very unequal masses that fall as a loose lattice, each a little aside, into an open box.
struct UnevenPile {
    int columns = 20;  ///< discs in a row and a column of the lattice
    double ratio = 1e6;
    Masses masses = Masses::two;  ///< half of the discs at random are heavy, or all between
    double friction = 0.5, restitution = 0;
    std::uint64_t seed = 1;
};

Scene scene_of(const UnevenPile& pile);

}  // namespace carom::torture

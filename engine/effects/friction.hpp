#pragma once

#include <cmath>

namespace carom {

/// A pair's Coulomb coefficient: the geometric mean of the two materials'. kernels/find_contacts.hpp has it
/// for lanes.
inline double pair_friction(double a, double b) {
    return std::sqrt(a * b);
}

}  // namespace carom

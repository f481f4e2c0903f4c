#pragma once

#include <cmath>

namespace carom {

/// A pair's Coulomb coefficient: the geometric mean of the two materials'. For pairs of rows solver `soft`
/// computes it in the world's precision (solvers/soft/contacts/pair_finder.cpp).
inline double pair_friction(double a, double b) {
    return std::sqrt(a * b);
}

}  // namespace carom

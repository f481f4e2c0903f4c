#pragma once

namespace carom {

/// A pair's Coulomb coefficient from those of the two materials, squared: the geometric mean is its root.
/// Taken as a root by whoever uses it, because lanes and scalars have different ones.
constexpr double pair_friction_squared(double a, double b) {
    return a * b;
}

}  // namespace carom

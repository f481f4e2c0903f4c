#pragma once

namespace carom {

/// Surface and bulk of a body or of the walls. A pair takes the larger restitution and the larger rolling
/// resistance of its two materials, and the geometric mean of its friction coefficients
/// (docs/conventions.md).
struct Material {
    double density = 1;      ///< kg/m², > 0; used where a body gives no mass
    double friction = 0;     ///< Coulomb coefficient, >= 0; with gravity needs the solver `soft` or `event`
    double restitution = 0;  ///< normal speed after / before, 0 ... 1
    /// Lever arm of the normal force against rolling, as a share of the disc's radius (of two discs:
    /// ra rb / (ra + rb)); no unit, >= 0. A disc rolls down a slope only if tan(slope) is larger. Needs the
    /// solver `soft`.
    double rolling_resistance = 0;

    friend bool operator==(const Material&, const Material&) = default;
};

}  // namespace carom

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "solvers/joints/joint_step.hpp"

namespace carom {

/// The stiffness with which swept joints turn each body: a joint that pulls at an arm r with the force T
/// draws it back with r . T a radian.
///
/// Impulses go on from substep to substep, so a body that its joints turn to and fro faster than a substep
/// can follow gains energy. So its inertia is seen as 4 h² k at least, k the stiffness: it swings by half a
/// radian a substep at most. With h² k, what trees need (JointSystem::stiffen), a grid of hinges shakes and
/// strains itself ever more. docs/decisions/0034-cases-of-shapes-and-joints.md has the measurements.
class JointStiffness {
  public:
    /// The factor by which stiffness counts: docs/decisions/0034-cases-of-shapes-and-joints.md.
    static constexpr double kStiffness = 4;
    /// Forgets all. @param rows  of bodies; rows beyond have no stiffness
    void begin(std::size_t rows) { sum_.assign(rows, 0); }
    /// @param moment  arm times impulse of a substep [N s m]
    void add(std::int32_t row, double moment) {
        if (static_cast<std::size_t>(row) < sum_.size()) sum_[static_cast<std::size_t>(row)] += moment;
    }
    /// The inertia of a body over that which a substep of h [s] sees; no unit, 0 ... 1.
    template <class Real>
    double seen(const Bodies<Real>& bodies, std::int32_t number, double h) const {
        const auto row = static_cast<std::size_t>(number);
        if (row >= sum_.size() || !(sum_[row] > 0)) return 1;
        const double least = kStiffness * h * sum_[row];  // k = sum / h
        const double inertia = inertia_of(bodies, row);
        return least > inertia ? inertia / least : 1;
    }
    /// The moment of inertia of a body that impulses move [kg m²].
    template <class Real>
    static double inertia_of(const Bodies<Real>& bodies, std::size_t row) {
        const double rim = rim_of(bodies, row);
        return 0.5 * rim * rim / bodies.inverse_mass(row);
    }
    std::size_t bytes() const { return sum_.capacity() * sizeof(double); }

  private:
    std::vector<double> sum_;  // N s m, by row
};

}  // namespace carom

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/impulse/impacts/flights.hpp"

namespace carom {

/// Impacts at one instant, solved together: impulses j >= 0 such that every normal velocity ends at or above
/// its target (-e times the approach; Newton's law for multiple impacts, Moreau 1988), and exactly there
/// where j > 0. Then friction: impulses along the surfaces that stop their sliding or reach Coulomb's limit,
/// which the normal impulses set. Projected Gauss-Seidel until converged, both times. The velocities are
/// unique, so the scene's symmetry is kept; with one coefficient e = 1 for all and no friction the energy is
/// exact. Cost: O(meetings · sweeps); meetings that share no body converge in one sweep.
template <class Real>
class SimultaneousImpacts {
  public:
    struct Impact {
        Meeting meeting;
        Encounter encounter;  ///< before
        double s;
        double target;                 ///< m/s, least normal velocity after
        double impulse = 0;            ///< N s
        double normal_velocity_after;  ///< m/s, before friction
        double inverse_mass_sum;
        std::size_t place_a, place_b;
        double friction = 0;          ///< Coulomb's coefficient, and what it needs:
        double slip = 0;              ///< m/s, velocity along the surface before
        double slip_bounced = 0;      ///< m/s, after the normal impulses, before friction
        double tangent_mass = 0;      ///< kg
        double friction_impulse = 0;  ///< N s
    };

    void reserve(std::size_t count) { impacts_.reserve(count), changes_.reserve(count); }
    /// To be called before the first impact is added, when rows have changed.
    /// @param place_of_row  [rows], all -1, as they are again after `carry_out`. Others may use it for other
    /// bodies.
    void begin(std::span<std::int32_t> place_of_row) { place_of_row_ = place_of_row; }
    void clear() { impacts_.clear(), changes_.clear(), has_friction_ = false; }

    void add(const Flights<Real>& flights, Meeting m, const Encounter& e, double s, double target);

    /// Solves all that was added, deflects the bodies and books the work as restitution and as friction.
    /// `negligible`: change of a velocity that is round-off [m/s].
    void carry_out(Flights<Real>& flights, double negligible = 0);

    const std::vector<Impact>& impacts() const { return impacts_; }
    std::size_t bytes() const;

  private:
    struct VelocityChange {
        std::int32_t row;
        ContactRecord sum;  ///< of all that impulses changed
    };

    std::size_t place_of(const Flights<Real>& flights, std::int32_t row);
    void measure_slip(const Flights<Real>& flights, Impact& i) const;
    template <class Fn>
    double with_changes(const Impact& i, const Fn& fn) const;
    double normal_velocity(const Impact& i) const;
    double slip(const Impact& i) const;
    void add_impulses(const Impact& i, const ImpactImpulses& added);
    void solve(const Flights<Real>& flights, double negligible);
    void solve_friction(const Flights<Real>& flights, double negligible);

    std::vector<Impact> impacts_;
    bool has_friction_ = false;
    std::vector<VelocityChange> changes_;   // of every body that takes part
    std::span<std::int32_t> place_of_row_;  // [rows], in changes_, or -1
};

extern template class SimultaneousImpacts<float>;
extern template class SimultaneousImpacts<double>;

}  // namespace carom

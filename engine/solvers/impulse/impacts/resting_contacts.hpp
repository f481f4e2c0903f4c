#pragma once

#include <cstdint>
#include <vector>

#include "solvers/impulse/impacts/flights.hpp"
#include "solvers/impulse/impacts/simultaneous_impacts.hpp"

namespace carom {

/// A contact that carries weight instead of bouncing. Known by handles, since rows move between steps.
struct RestingContact {
    BodyId a;
    BodyId b;               ///< unset for a wall
    std::int32_t wall = 0;  ///< WallSide, or 0
    double force = 0;       ///< N, of the last step: where the next solve starts
};

/// A contact at rest in this substep.
struct PressedMeeting {
    Meeting meeting;
    double force;  ///< N, in: where to start; out: what it carries
};

/// Contacts at rest, held for a whole substep: their approach is stopped without a bounce, and the contact
/// forces that keep them from accelerating into each other become part of the bodies' accelerations. The
/// forces solve 0 <= force ⟂ relative normal acceleration >= 0 (Baraff 1994) by projected Gauss-Seidel, which
/// has one solution in accelerations and so respects the scene's symmetry. Held bodies stay put exactly: no
/// creep, no energy.
template <class Real>
class RestingContacts {
  public:
    /// Stops and holds `contacts` from the start of the substep on. Rows whose acceleration changed are
    /// appended to `held`, each once.
    void hold(Flights<Real>& flights, std::vector<PressedMeeting>& contacts, std::vector<std::int32_t>& held);

    void reserve(std::size_t count) { solved_.reserve(count), stopped_.reserve(count); }
    std::size_t bytes() const {
        return solved_.capacity() * sizeof(Solved) + stopped_.bytes() +
               place_of_row_.capacity() * sizeof(std::int32_t);
    }

  private:
    struct Solved {
        Vec2 normal;
        double unforced;  ///< m/s², what curved motion (vt² / distance) and the rest of a separation's speed
                          ///< add to the separation's acceleration
        double inverse_mass_sum;  ///< 1/kg; 0 = moving apart, not carried
    };

    void stop(Flights<Real>& flights, const std::vector<PressedMeeting>& contacts);
    void carry(Flights<Real>& flights, std::vector<PressedMeeting>& contacts);
    void book(Flights<Real>& flights, const std::vector<PressedMeeting>& contacts);

    SimultaneousImpacts<Real> stopped_;
    std::vector<std::int32_t> place_of_row_;  // for these, [rows], all -1
    std::vector<Solved> solved_;
};

extern template class RestingContacts<float>;
extern template class RestingContacts<double>;

}  // namespace carom

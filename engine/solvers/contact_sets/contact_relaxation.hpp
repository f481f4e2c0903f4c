#pragma once

#include <array>
#include <span>
#include <vector>

#include "sleeping/islands.hpp"
#include "solvers/contact_sets/local_contact.hpp"

namespace carom {

/// How near contacts are brought to their laws, and what they may add to the energy meanwhile.
struct RelaxationEffort {
    int rounds;       // at most
    double accuracy;  // share of what gravity adds to a velocity by which that of a body may be off
    /// Energy that contacts may add to all bodies in a substep, in units of m (what gravity adds to a
    /// velocity)²: a load that is let go gives back what its contacts gave way by.
    double slack;
};

/// Contacts solved for the velocities of their bodies in place of their impulses, one body after the other,
/// so that light bodies between heavy ones follow these at once, however large the ratio of their masses.
///
/// A contact is a damper that keeps what it carried: λ = max(0, λ₀ + k (floor - v_n)), along the tangent
/// s (λ₀ - k v_t), where the share s <= 1 is what Coulomb's law leaves of it at the speed of before. The
/// velocities are to be where
///
///     ½ (v - v₀)ᵀ M (v - v₀) + sum of the contacts' λ² / 2 k
///
/// is least, v₀ being those without contacts. Each body goes to where it is least for that body alone, with
/// its contacts all at once, from the velocities that it had before. Then contacts that gave way too far are
/// stiffened, λ₀ is what they carry by now, and all is done once more. What is left is left to the next
/// substep, which begins with these λ₀.
///
/// What is squeezed between things that do not give way has no solution: loads would grow without end. They
/// are bounded by what all bodies that touch each other could ask for.
///
/// Impulses that would add energy are not taken over: docs/decisions/0032-piles-of-uneven-masses.md. Source:
/// the unconstrained convex formulation of contact (Todorov 2014; Castro et al. 2022), augmented Lagrangians
/// (Alart & Curnier 1991), descent by blocks of coordinates (Tseng 2001).
/// kSize: numbers a body has, 3 with rotation, else 2.
template <int kSize>
class ContactRelaxation {
  public:
    using Velocity = std::array<double, kSize>;  // m/s: x, y, rim speed

    /// Which contacts each body has. Cost: O(bodies + contacts).
    void begin(std::span<const LocalContact> contacts, std::size_t bodies);
    /// @param inverse_mass  1/kg, negative for a fixed angle
    /// @param start  m/s, at the start of the substep  @param free  at its end without contacts
    /// @param swept  at its end by sweeps over impulses
    void set_body(std::size_t body, double inverse_mass, const Velocity& start, const Velocity& free,
                  const Velocity& swept);
    /// @param contacts  with the impulses to begin with; out: with new ones
    /// @param fall  m/s, what gravity adds in a substep, above zero
    /// Cost: O(contacts) times a few dozen at most; less where few move.
    void solve(std::span<LocalContact> contacts, double fall, const RelaxationEffort& effort);
    const Velocity& velocity(std::size_t body) const { return velocity_[body]; }

    std::size_t bytes() const;

  private:
    static constexpr bool kIsRough = kSize == 3;
    static constexpr std::size_t kRows = kIsRough ? 3 : 1;  // of a contact: normal, tangent, rolling
    using Rows = std::array<double, kRows>;
    using Matrix = std::array<double, kSize * kSize>;  // the lower triangle is used

    struct Law {
        std::int32_t a, b;
        double nx, ny;
        double of_a;       // the share s of body a's rim speed in the rolling velocity
        Rows surface;      // m/s, of what does not move
        double floor;      // m/s
        double stiffness;  // kg
        double friction, rolling;
        Rows carried;  // N s, λ₀
        Rows share;    // of tangential and rolling impulses that the law leaves
    };
    /// How impulses fit the velocities of bodies that touch each other [J].
    struct Fit {
        bool is_driven = false;        // by a surface that moves
        double energy = 0;             // of the bodies, and the slack
        double missed = 0;             // what they have gained less the work of the impulses
        double along = 0, square = 0;  // of what impulses give: times the change of velocities, alone
    };

    void bound_loads();
    void describe(std::span<const LocalContact> contacts, double fall);
    static Rows part_of_velocity(const Law& law, bool is_b, const Velocity& velocity);
    Rows velocity_of(const Law& law) const;
    static double impulse_of(const Law& law, std::size_t row, double velocity);
    Rows impulses_of(const Law& law) const;
    bool find_shares();
    double value() const;
    double gain() const;
    bool relax(std::size_t body);
    void sweep();
    bool stiffen();
    void start_without_loads();
    void take_back();
    static void give(const Law& law, bool is_b, const Rows& impulses, Velocity& given);
    void fit_impulses();

    double fall_ = 0, accurate_ = 0, slack_ = 0;    // m/s
    Islands touching_;                              // bodies that touch each other, supports left out
    std::vector<double> most_;                      // N s, of each body's contacts
    std::vector<Law> laws_;                         // of the contacts
    std::vector<std::uint32_t> first_, of_bodies_;  // contacts of each body
    std::vector<std::uint8_t> is_due_;              // bodies to be looked at
    std::vector<Rows> by_others_;                   // m/s, of the contacts of a body: by all but that body
    std::vector<Velocity> mass_;                    // kg
    std::vector<Velocity> start_, free_, velocity_, swept_;  // m/s
    std::vector<Rows> impulses_;                             // N s, of the contacts
    std::vector<Velocity> given_;                            // N s, by these
    std::vector<Fit> fits_;                                  // of bodies that touch each other
};

extern template class ContactRelaxation<2>;
extern template class ContactRelaxation<3>;

}  // namespace carom

#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "constraints/contact_law.hpp"
#include "constraints/contact_rows.hpp"
#include "constraints/contacts_of_bodies.hpp"
#include "effects/flight.hpp"
#include "state/world_state.hpp"

namespace carom {

/// The bodies of a substep whose contacts are solved, before they move.
template <class Real>
struct SubstepBodies {
    std::size_t count;         ///< rows below it have records, those beyond sleep
    const Real* origin;        ///< [rows][4]: x, y [m] at the start of the step, and two numbers more
    Real* velocity;            ///< [rows][4], at the end of the substep
    StartColumns<Real> start;  ///< velocities at the start of the substep
    Real* displacement;        ///< [rows][2], m, until the start of the substep
    Real* turn;                ///< m, at the rim, until the start of the substep; null without rotation
    double h, elapsed;         ///< s: the substep's length, and the step's time at its start
    Real gain_x, gain_y;       ///< m/s, what gravity adds in a substep
    Real decay, spin_decay;    ///< what drag leaves in a substep
    double uniform_friction, uniform_rolling;
};

/// What impacts did to the sums of a substep besides the books.
struct ImpactCounters {
    std::int64_t impacts = 0;
    std::int64_t of_walls = 0;   ///< of these
    std::int64_t inelastic = 0;  ///< of these too: slow ones, or of bodies that had too many
};

/// Impacts of solver `soft`: each at its own time within a substep, by the exact law, with friction and spin.
///
/// What touches slowly or is pressed is a contact, which the sweeps solve; what comes fast is an impact,
/// which they do not see. A body's path in a substep is what it will be moved by: the parabola of free
/// flight, or the straight line of a body that contacts hold. Impacts are carried out in the order of time,
/// each with the velocities of that moment, so that it changes the kinetic energy by -(1 - e²) m_eff v_n² / 2
/// and friction's work, never up.
///
/// A crowd that collapses has ever more, ever slower impacts. A body has a budget of impacts a step; what
/// exceeds it, or comes slower than gravity would make it in two substeps, leaves without restitution and is
/// a contact from then on. So the work of a step is bounded by the bodies there are.
///
/// Cost: nothing where no restitution is called for; else a look at each contact once a step, and about .3 us
/// an impact. Source: docs/decisions/0022-impacts-in-soft.md.
template <class Real>
class Impacts {
  public:
    ImpactCounters counters;

    /// Tells impacts from contacts among what can touch in this step.
    /// @param candidates  of the supports
    /// @param dt, h  s, of the step and of a substep
    void mark(const WorldState<Real>& world, ContactRows<Real>& pairs, std::int64_t version,
              ContactRows<Real>& supports, const ContactRows<Real>& candidates, double dt, double h,
              Vec2 gravity_change);

    /// Carries out the impacts of a substep.
    /// @param gravity_work  J, gravity's work on velocities, to be booked
    void carry_out_all(const SubstepBodies<Real>& bodies, Books& books, double& gravity_work);

    /// Rows have changed: which contacts each body is in is found anew.
    void forget() { known_version_ = -1; }
    std::size_t bytes() const;

  private:
    /// A contact: its place in the store of pairs or of supports.
    struct Place {
        std::uint32_t index : 31, is_support : 1;
    };
    struct Event {
        double time;  // s, in the substep
        Place place;
        std::int32_t a, b;  // row and Partner: ties of time are broken by them
        std::uint32_t impacts_a, impacts_b;
    };
    struct Later {
        bool operator()(const Event& p, const Event& q) const {
            if (p.time != q.time) return p.time > q.time;
            if (p.a != q.a) return p.a > q.a;
            return p.b > q.b;
        }
    };
    /// What a body has had of impacts in the present step.
    struct Tally {
        std::uint32_t step = 0;  // of the other two
        float spent = 0;         // of its budget
        float fastest = 0;       // m/s
    };
    /// How a body moves through a substep: by what kernels/advance_bodies.hpp will move it. A cache line.
    struct alignas(64) Mover {
        Vec2 x, v, acceleration;    // m, m/s, m/s², at the start of the substep
        double radius = 0;          // m
        std::uint32_t impacts = 0;  // ever: what was foreseen with another number is void
        std::uint32_t substep = 0;  // for which this holds

        Vec2 position_at(double t) const { return x + t * v + (0.5 * t * t) * acceleration; }
        Vec2 velocity_at(double t) const { return v + t * acceleration; }
    };
    /// A disc and a plane that supports it, at the start of a substep.
    struct Clearance {
        double width, rate, acceleration;  // m, m/s, m/s²
    };

    ContactRows<Real>& store_of(Place place) const { return place.is_support ? *supports_ : *pairs_; }
    Partner partner_of(Place place) const;
    bool is_impact(Place place) const;
    bool is_pressed(Place place) const { return store_of(place).normal_impulse[place.index] > 0; }
    double restitution_of(Place place) const;
    double smaller_radius(Place place) const;
    Tally& tally_of(std::int32_t row);

    Mover path_of(std::size_t row) const;
    const Mover& mover_of(std::int32_t row);
    Mover other_of(Place place, Partner other);
    DoubleBody body_of(std::int32_t row, const Mover& mover, double time) const;
    Clearance clearance_of(Place place, const Mover& a) const;

    void mark_in(ContactRows<Real>& rows, bool are_supports, std::size_t first, std::size_t last, double dt);
    void foresee(Place place, double time);
    bool takes_part(Place place, double speed, double left, double noise);
    void look_at_pair(Place place, const Mover& a, const Mover& b, double from);
    void look_at_support(Place place, double from);
    void look_at_all_of(std::int32_t row, double from);
    bool carry_out(Place place, double time, Books& books, double& gravity_work);
    void change(std::int32_t row, const DoubleBody& before, const DoubleBody& after, double time,
                double& gravity_work);
    bool is_exhausted(Place place);
    bool spend(Place place, double restitution, double speed);
    void make_contact(Place place, Vec2 normal, double gap, double time);

    // These members hold for the present step alone.
    const WorldState<Real>* world_ = nullptr;
    ContactRows<Real>*pairs_ = nullptr, *supports_ = nullptr;
    const ContactRows<Real>* candidates_ = nullptr;  // of supports
    const SubstepBodies<Real>* bodies_ = nullptr;    // in a substep
    double rest_speed_ = 0;                          // m/s
    Vec2 gravity_;                                   // m/s²
    std::vector<Place> impacts_;
    bool are_supports_known_ = false;

    std::int64_t version_ = -1, known_version_ = -1;  // of the pairs, and of those in of_pairs_
    ContactsOfBodies<Real> of_pairs_, of_supports_;
    std::vector<Event> queue_;
    std::vector<Tally> tallies_;
    std::vector<Mover> movers_;
    std::uint32_t step_ = 0, substep_ = 0;
};

extern template class Impacts<float>;
extern template class Impacts<double>;

}  // namespace carom

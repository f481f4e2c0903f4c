#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "constraints/contact_rows.hpp"
#include "constraints/contacts_of_bodies.hpp"
#include "effects/contact_law.hpp"
#include "effects/flight.hpp"
#include "parallel/interruption.hpp"
#include "solvers/soft/contacts/contact_settings.hpp"
#include "solvers/soft/contacts/step_view.hpp"
#include "solvers/soft/impacts/closing_chunks.hpp"
#include "solvers/soft/impacts/held_impacts.hpp"
#include "solvers/soft/impacts/impact_budget.hpp"
#include "solvers/soft/impacts/impact_paths.hpp"
#include "solvers/soft/impacts/shape_impacts.hpp"
#include "state/world_state.hpp"

namespace carom {

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
/// Cost: nothing where no restitution is called for; else a look at each contact once a step, and about .65
/// us an impact. Source: docs/decisions/0022-impacts-in-soft.md.
template <class Real>
class Impacts {
  public:
    ImpactCounters counters;
    HeldImpacts<Real> held;      ///< told of joints, if there are any, once contacts are marked
    ShapeImpacts<Real> shapes;   ///< carried out before these
    ClosingChunks left_closing;  ///< what those of this substep leave

    /// Tells impacts from contacts among what can touch in this step.
    void mark(const WorldState<Real>& world, const StepView<Real>& step, const Candidates<Real>& neighbours);

    /// Discs have been deflected by shapes, which are none of these contacts: what they may hit now, fast, is
    /// an impact, too.
    /// @param velocity  records
    void note_deflected(const Column<Real>& velocity);
    /// Carries out the impacts of a substep.
    /// @param gravity_work  J, gravity's work on velocities, to be booked
    /// @param interruption  of the step: the rest is left if it is to end
    void carry_out_all(const SubstepBodies<Real>& bodies, Books& books, double& gravity_work,
                       Interruption& interruption);

    /// Rows have changed: which contacts each body is in is found anew.
    void forget() { known_version_ = -1; }
    std::size_t bytes() const;

  private:
    enum Kind : std::uint32_t { kPair, kSupport, kStrangers };
    /// A contact: its place in the store of pairs or of supports, or among strangers.
    struct Place {
        std::uint32_t index : 30;
        Kind kind : 2;

        bool is_support() const { return kind == kSupport; }
        bool has_row() const { return kind != kStrangers; }
    };
    /// Two bodies that are no candidates: one of them was deflected out of its margin in this step.
    struct Strangers {
        std::int32_t a, b;            // rows, a < b
        std::int32_t next_a, next_b;  // number of the next ones of the same body; -1: none
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
    /// A disc and a plane that supports it, at the start of a substep.
    struct Clearance {
        double width, rate, acceleration;  // m, m/s, m/s²
    };

    ContactRows<Real>& store_of(Place place) const { return place.is_support() ? *supports_ : *pairs_; }
    std::int32_t row_of(Place place) const;
    Partner partner_of(Place place) const;
    bool is_impact(Place place) const;
    bool is_pressed(Place place, double speed = 0) const;
    double restitution_of(Place place) const;
    double smaller_radius(Place place) const;
    std::int32_t lighter_of(Place place) const {
        const auto mass_of = [&](std::int32_t row) {
            return world_->bodies.mass[static_cast<std::size_t>(row)];
        };
        const std::int32_t a = row_of(place);
        if (place.is_support()) return a;
        const std::int32_t b = partner_of(place).row();
        return mass_of(b) < mass_of(a) ? b : a;
    }
    void set_materials(Place place, ContactTerms<double>& terms) const;
    Clearance clearance_of(Place place, const Mover& a) const;

    void mark_in(ContactRows<Real>& rows, Kind kind, std::size_t first, std::size_t last);
    void foresee(Place place, double time);
    bool takes_part(Place place, double speed, double left, double noise);
    void hide_from_sweeps(Place place, Vec2 v);
    void look_at_pair(Place place, const Mover& a, const Mover& b, double from);
    void look_at_support(Place place, double from);
    void look_at(Place place, double from);
    void find_strangers(std::int32_t row, double from);
    void mark_known(std::int32_t row);
    template <class Fn>
    void for_each_stranger_of(std::int32_t row, const Fn& fn) const;
    void look_at_all_of(std::int32_t row, double from);
    void find_contacts_of_bodies() {
        if (known_version_ != version_) of_pairs_.find(*pairs_, world_->bodies.moving(), true);
        known_version_ = version_;
        if (!are_supports_known_) of_supports_.find(*supports_, world_->bodies.moving(), false);
        are_supports_known_ = true;
    }
    bool carry_out(Place place, double time, Books& books, double& gravity_work);
    void make_contact(Place place, Vec2 normal, double gap, double time);

    // These members hold for the present step alone.
    const WorldState<Real>* world_ = nullptr;
    ContactRows<Real>*pairs_ = nullptr, *supports_ = nullptr;
    const ContactRows<Real>* candidates_ = nullptr;  // of supports
    const Candidates<Real>* neighbours_ = nullptr;
    const ContactSettings* settings_ = nullptr;
    const TaskGroups* groups_ = nullptr;
    const SubstepBodies<Real>* bodies_ = nullptr;  // in a substep
    double dt_ = 0, rest_speed_ = 0;               // s, m/s
    Vec2 gravity_;                                 // m/s²
    double overshoot_ = 0;                         // m, that any body may leave its margin by
    std::vector<Place> impacts_;
    std::vector<Strangers> strangers_;
    std::vector<std::int32_t> first_strangers_;  // of each row; -1: none
    std::vector<std::uint32_t> mark_of_;         // of each row: mark_ if it was marked last
    std::uint32_t mark_ = 0;
    Column<std::int32_t> near_rows_;
    bool are_supports_known_ = false;

    std::int64_t version_ = -1, known_version_ = -1;  // of the pairs, and of those in of_pairs_
    ContactsOfBodies<Real> of_pairs_, of_supports_;
    ImpactPaths<Real> paths_;
    std::vector<std::int32_t> struck_;  // rows that the last impact changed, if joints hold some; else none
    ImpactBudget budget_;
    std::vector<Event> queue_;
};

extern template class Impacts<float>;
extern template class Impacts<double>;

}  // namespace carom

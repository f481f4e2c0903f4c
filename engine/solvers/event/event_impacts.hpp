#pragma once

#include <cstdint>
#include <vector>

#include "solvers/event/event_store.hpp"
#include "state/books.hpp"

namespace carom {

/// Rules for impacts that would otherwise follow each other ever faster.
struct CollapseRule {
    double contact_time = 0;   ///< s: a disc hit again within it bounces elastically (TC model)
    double slowest_speed = 0;  ///< m/s: nothing leaves an impact slower; round-off
};

/// One impact, measured at its instant.
struct EventContact {
    std::int32_t a = 0;          ///< a disc that can move
    std::int32_t b = 0;          ///< a disc, or -1 - side of the walls
    Vec2 normal;                 ///< from A to B
    double normal_velocity = 0;  ///< m/s, of B relative to A; negative = approaching
    double slip = 0;             ///< m/s, of B's surface relative to A's along the normal turned by 90°
    double separation = 0;       ///< m
    double friction = 0;
    double target = 0;                 ///< m/s, least normal velocity after
    double inverse_mass = 0;           ///< 1/kg, along the normal: of both together
    double inverse_slip_mass = 0;      ///< 1/kg, along the surface
    double impulse = 0;                ///< N s, on B along the normal
    double friction_impulse = 0;       ///< N s, on B along the normal turned by 90°
    double normal_velocity_after = 0;  ///< m/s, before friction
    double slip_bounced = 0;           ///< m/s, after the normal impulses, before friction
    double slip_after = 0;             ///< m/s
};

struct EventCounters {
    std::int64_t impacts = 0;
    std::int64_t wall_impacts = 0;
    std::int64_t simultaneous_impacts = 0;
    std::int64_t collapse_impacts = 0;  ///< made elastic, or given the least speed, by the collapse rule
    std::int64_t crossings = 0;
    std::int64_t forecasts = 0;   ///< of all impacts of a disc
    std::int64_t pair_tests = 0;  ///< times of impact of two discs that were looked for
};

/// Carries out impacts. One alone, by Newton's law of restitution and Coulomb's law of friction:
///     Jn = (1 + e) m_eff |vn|,   Jt = -vt m_slip, but at most μ Jn   (m_slip = m_eff / 3 for two discs)
/// Several at one instant together: normal impulses such that every normal velocity ends at or above its
/// target and exactly there where the impulse is not zero (Moreau 1988), then friction within their limits;
/// projected Gauss-Seidel. The velocities are unique, so the symmetry of a scene is kept.
///
/// Source: Newton's and Coulomb's laws for discs (Walton 1993, without tangential restitution); collapse
/// rule: Luding & McNamara, "How to handle the inelastic collapse of a dissipative hard-sphere gas with the
/// TC model", Granular Matter 1 (1998).
class EventImpacts {
  public:
    CollapseRule rule;
    EventCounters* counters = nullptr;
    Books* books = nullptr;  ///< null: none are kept

    /// The contact of two, or of a disc and a wall, at `time`.
    EventContact measure(const EventStore& store, std::int32_t a, std::int32_t b, double time) const;

    /// One impact alone. Both discs' paths begin anew at `time`.
    void carry_out(EventStore& store, EventContact& contact, double time);

    /// Several at one instant.
    void carry_out(EventStore& store, std::vector<EventContact>& contacts, double time);

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.rule, self.place_of_disc_);
    }

  private:
    struct Change {
        Vec2 velocity;
        double spin = 0;
    };

    void set_targets(const EventStore& store, EventContact& contact, double time);
    void apply(EventStore& store, const EventContact& contact, double time);
    void book(const EventStore& store, const EventContact& contact);
    void measure_after(const EventStore& store, std::vector<EventContact>& contacts, bool with_friction);
    double solve_sweep(const EventStore& store, std::vector<EventContact>& contacts, bool with_friction);
    Change* change_of(const EventStore& store, std::int32_t disc);

    std::vector<Change> changes_;              // of every disc that takes part
    std::vector<std::int32_t> place_of_disc_;  // [discs], in changes_, or -1
};

}  // namespace carom

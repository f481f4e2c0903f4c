#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "narrowphase/impact_time.hpp"
#include "solvers/impulse/flights.hpp"
#include "solvers/impulse/impact_queue.hpp"
#include "solvers/impulse/resting_contacts.hpp"
#include "solvers/impulse/simultaneous_impacts.hpp"
#include "solvers/impulse/tiles.hpp"
#include "state/handles.hpp"

namespace carom {

/// Counters of the impulse solver (the docstrings of Profile say what each means).
struct ImpulseCounters {
    std::int64_t impacts = 0;
    std::int64_t wall_impacts = 0;
    std::int64_t simultaneous_impacts = 0;
    std::int64_t resting_contacts = 0;
    std::int64_t overlaps_corrected = 0;
    std::int64_t unresolved_impacts = 0;
};

/// A meeting that the kernels found, as it looks at the start of the substep. If contacts can rest, only the
/// meeting itself is filled in.
struct FoundMeeting {
    Meeting meeting;
    std::uint32_t tile = 0;  ///< of the impact queue, where it happens
    bool overlaps = false;   ///< by more than the slop
    double impact = kNever;  ///< s, clock of the impact if nothing deflects one of the bodies before
};

/// Solver `impulse`: every impact of a substep at its own time, in the order of time.
///
/// The kernels hand over the few meetings that can touch in this substep. Overlaps left from before are
/// pushed apart, contacts at rest are held; then the earliest impact is carried out, its two bodies fly on
/// along new paths, and what they can hit from there is foreseen anew, until nothing is left in the substep.
/// Impacts at one instant are solved together, so that the result keeps the scene's symmetry.
///
/// Friction: each impact's surfaces stick, or slide within Coulomb's limit (constraints/contact_law.hpp).
/// Contacts at rest have none, so that a world with friction must have nothing that rests: no gravity.
///
/// Energy: an impact changes it by -m_eff (1 - e²) vn² / 2, by what friction takes and by nothing else;
/// overlaps never feed velocity.
/// Cost: O(impacts · log(impacts of the substep)), about 100 ns each.
/// Source: event-driven molecular dynamics (Alder & Wainwright 1959; Lubachevsky 1991), confined to a step.
template <class Real>
class ImpulseSolver {
  public:
    ImpulseSolver();

    Flights<Real> flights;
    ImpulseCounters counters;

    /// To be called when candidates and flights of a substep are there, before the rest.
    /// @param slack  m, see FindImpacts::slack
    void begin_substep(const Candidates<Real>& candidates, double slack, const KernelTable<Real>& kernels);

    /// Looks at a meeting that the kernels found. Reads only, so that chunks can ask on several threads.
    FoundMeeting examine(Meeting meeting) const;

    /// Sorts the meetings the kernels found into overlaps, contacts at rest and possible impacts, deals with
    /// the first two and foresees the third. Every meeting is listed once.
    void settle_contacts(std::span<const FoundMeeting> found, const Handles& handles);

    /// Carries out every impact until the end of the substep.
    void resolve_impacts();

    /// Rows held by contacts at rest this substep, each once: their flight is not the common one.
    const std::vector<std::int32_t>& held_rows() const { return held_; }

    /// Forgets contacts at rest, e.g. because bodies were moved or removed from outside.
    void forget_contacts() { persisting_.clear(); }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.counters, self.persisting_);
        if constexpr (!std::is_const_v<Self>) self.flights.accelerations.clear();
    }

  private:
    void collect_persisting(const Handles& handles);
    void drop_duplicates_at_rest();
    void keep_resting(Meeting m, double force);
    void take_examined(std::span<const FoundMeeting> found);
    void foresee_pushed();
    void settle_with_rest(std::span<const FoundMeeting> found, const Handles& handles);
    void separate();
    void sort_out(Meeting m);
    double impact_time(Meeting m, double from) const;
    void foresee(Meeting meeting, double from);
    double time_at_wall(std::int32_t row, const Flight& f, std::int32_t side, double from) const;
    double time_of_pair(Meeting m, const Flight& fa, const Flight& fb, double from) const;
    void queue(Meeting m, double from, double s);
    void push(Meeting m, double s, std::size_t tile);
    void prefetch_meeting(Meeting m) const;
    void prefetch_margins(Meeting m) const;
    void prefetch_tile(std::size_t tile) const;
    void foresee_walls(std::int32_t row, double from);
    std::size_t keep_touchable(std::int32_t row, std::size_t found);
    void foresee_near(std::int32_t row, double from);
    void foresee_all_of(std::int32_t row, double from);
    void take_simultaneous(const Impact& first);
    void carry_out(const Impact& impact);
    void carry_out_together();
    void note_impact(Meeting m, const Encounter& e);
    double restitution_of(Meeting m, const Encounter& e) const;
    double approach_noise(Meeting m) const;
    double rest_height(Meeting m) const;
    bool is_foreseen_rightly(const Impact& impact) const;

    ImpactQueue queue_;
    RestingContacts<Real> resting_;
    std::vector<Meeting> overlaps_;
    std::vector<double> separation_targets_;
    std::vector<PressedMeeting> at_rest_;
    std::vector<RestingContact> persisting_;  // contacts that stopped bouncing, for the next substep
    std::vector<std::int32_t> held_;
    std::vector<Impact> simultaneous_;
    SimultaneousImpacts<Real> together_;
    std::vector<std::int32_t> moved_;
    Column<std::int32_t> near_;
    std::vector<std::uint32_t> deflections_;      // [rows], how often each body was deflected, ever
    const KernelTable<Real>* kernels_ = nullptr;  // of this substep
    const Candidates<Real>* candidates_ = nullptr;
    double slack_ = 0;      // m, see FindImpacts::slack
    double overshoot_ = 0;  // m, farthest that a path of this substep leaves its margin
    Tiles tiles_;
    std::size_t budget_ = 0;  // impacts this substep may still carry out
};

extern template class ImpulseSolver<float>;
extern template class ImpulseSolver<double>;

}  // namespace carom

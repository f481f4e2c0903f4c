#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "parallel/executor.hpp"
#include "solvers/impulse/impacts/flights.hpp"
#include "solvers/impulse/impacts/impact_lists.hpp"
#include "solvers/impulse/impacts/impact_resolver.hpp"
#include "solvers/impulse/impacts/resolver_pool.hpp"
#include "solvers/impulse/impacts/resting_contacts.hpp"
#include "solvers/impulse/impacts/tiles.hpp"
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
    std::uint32_t tile = 0;  ///< where it happens
    bool overlaps = false;   ///< by more than the slop
    double impact = kNever;  ///< s, clock of the impact if nothing deflects one of the bodies before
};

/// Lists of meetings, one a chunk of pairs where chunks run on several threads, one after the other.
struct FoundMeetings {
    std::vector<std::vector<FoundMeeting>> lists;  ///< more than `count` after a larger substep
    std::size_t count = 0;

    std::size_t size() const {
        std::size_t sum = 0;
        for (std::size_t list = 0; list < count; ++list) sum += lists[list].size();
        return sum;
    }
    /// Calls fn(meeting, soon) for each: `soon` comes some places later in its list, or null. Meetings are in
    /// the order of the plane, which memory follows if told a little ahead.
    template <class Fn>
    void for_each(const Fn& fn) const {
        constexpr std::size_t kAhead = 8;  // meetings: about as long as a line of memory is under way
        for (std::size_t list = 0; list < count; ++list) {
            const std::vector<FoundMeeting>& found = lists[list];
            for (std::size_t i = 0; i < found.size(); ++i)
                fn(found[i], i + kAhead < found.size() ? &found[i + kAhead] : nullptr);
        }
    }
};

/// Solver `impulse`: every impact of a substep at its own time, in the order of time.
///
/// The kernels hand over the few meetings that can touch in this substep. Overlaps left from before are
/// pushed apart, contacts at rest are held; then the earliest impact is carried out, its two bodies fly on
/// along new paths, and what they can hit from there is foreseen anew, until nothing is left in the substep.
/// Impacts at one instant are solved together, so that the result keeps the scene's symmetry. In a large
/// world that is done tile by tile (tiles.hpp): the bodies of a tile fit into the cache, while impacts in the
/// order of time alone jump all over memory, and tiles that are not beside each other can be worked on at the
/// same time. Across the border of two tiles an impact can so be carried out after one that it would have
/// changed. docs/decisions/0002-impulse-solver.md and 0044-impacts-on-threads.md have the measurements.
///
/// Friction: each impact's surfaces stick, or slide within Coulomb's limit (effects/contact_law.hpp).
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

    FlightColumns<Real> columns;
    Flights<Real> flights;  ///< of these columns
    ImpulseCounters counters;

    /// To be called when candidates and flights of a substep are there, before the rest.
    /// @param slack  m, see FindImpacts::slack
    void begin_substep(const Candidates<Real>& candidates, double slack, const KernelTable<Real>& kernels);

    /// Looks at a meeting that the kernels found. Reads only, so that chunks can ask on several threads.
    FoundMeeting examine(Meeting meeting) const;

    /// Sorts the meetings the kernels found into overlaps, contacts at rest and possible impacts, deals with
    /// the first two and foresees the third. Every meeting is listed once.
    void settle_contacts(const FoundMeetings& found, const Handles& handles);

    /// Carries out every impact until the end of the substep.
    void resolve_impacts(const Executor& executor);

    /// Rows held by contacts at rest this substep, each once: their flight is not the common one.
    const std::vector<std::int32_t>& held_rows() const { return held_; }

    /// Forgets contacts at rest, e.g. because bodies were moved or removed from outside.
    void forget_contacts() { outcome_.resting.clear(), held_.clear(); }

    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.counters, self.outcome_.resting);
        if constexpr (!std::is_const_v<Self>) self.columns.accelerations.clear(), self.held_.clear();
    }

  private:
    void collect_persisting(const Handles& handles);
    void drop_duplicates_at_rest();
    void take_examined(const FoundMeetings& found);
    void foresee_pushed();
    void settle_with_rest(const FoundMeetings& found, const Handles& handles);
    void separate();
    void sort_out(Meeting m);
    void prefetch_meeting(Meeting m) const;
    double rest_height(Meeting m) const;
    void resolve_phase(std::size_t phase, const Executor& executor);
    void work_on_tile(std::size_t phase, std::size_t number);
    void collect(ImpactOutcome& outcome);
    void take_left();

    Tiles tiles_;
    ImpactTerms<Real> terms_;              // of this substep
    ImpactResolver<Real> all_;             // of all of the plane
    ImpactOutcome outcome_;                // of that, in the end of all
    ImpactLists lists_;                    // of tiles to come
    std::vector<ImpactOutcome> outcomes_;  // of the tiles of a phase
    ResolverPool<Real> resolvers_;         // for them
    RestingContacts<Real> resting_;
    std::vector<Meeting> overlaps_;
    std::vector<double> separation_targets_;
    std::vector<PressedMeeting> at_rest_;
    std::vector<std::int32_t> held_;
    std::vector<std::int32_t> moved_;
    std::vector<std::uint32_t> deflections_;  // [rows], how often each body was deflected, ever
    std::vector<std::int32_t> place_of_row_;  // [rows], all -1, for the solvers of simultaneous impacts
};

extern template class ImpulseSolver<float>;
extern template class ImpulseSolver<double>;

}  // namespace carom

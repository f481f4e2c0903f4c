#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "broadphase/candidates.hpp"
#include "narrowphase/impact_time.hpp"
#include "solvers/impulse/impacts/flights.hpp"
#include "solvers/impulse/impacts/impact_lists.hpp"
#include "solvers/impulse/impacts/resting_contacts.hpp"
#include "solvers/impulse/impacts/simultaneous_impacts.hpp"
#include "solvers/impulse/impacts/tiles.hpp"

namespace carom {

/// What all resolvers of the impacts of a substep have in common.
template <class Real>
struct ImpactTerms {
    const Candidates<Real>* candidates = nullptr;
    const KernelTable<Real>* kernels = nullptr;
    const Tiles* tiles = nullptr;
    std::span<std::uint32_t> deflections;  ///< [rows], how often each body was deflected, ever
    std::span<std::int32_t> places;        ///< [rows], for SimultaneousImpacts
    double slack = 0;                      ///< m, see FindImpacts::slack
};

/// What comes of resolving impacts, of tiles or of all of the plane.
struct ImpactOutcome {
    /// A body that was deflected, of which it is yet to be foreseen what it can hit.
    struct Unforeseen {
        std::int32_t row;
        std::uint32_t deflections;  ///< of the body; if it has more by now there is nothing to foresee
        double from;                ///< s, clock
    };

    std::int64_t impacts = 0, wall_impacts = 0, simultaneous_impacts = 0;
    std::vector<RestingContact> resting;       ///< contacts that stopped bouncing, for the next substep
    std::vector<PlacedImpact> of_other_tiles;  ///< foreseen, of phases to come
    std::vector<Impact> left;                  ///< out of reach, or beyond the budget
    std::vector<Unforeseen> left_bodies;       ///< out of reach
    double overshoot = 0;                      ///< m, farthest that a path of this substep leaves its margin
    Books books;                               ///< if they are its own

    /// Begins another substep, with contacts at rest kept.
    void begin(double overshoot_so_far) {
        impacts = wall_impacts = simultaneous_impacts = 0;
        of_other_tiles.clear(), left.clear(), left_bodies.clear();
        overshoot = overshoot_so_far;
    }
    std::size_t bytes() const {
        const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
        return of(resting) + of(of_other_tiles) + of(left) + of(left_bodies);
    }
};

/// Foresees impacts and carries them out one after the other, those of a tile or of all of the plane: each
/// deflected body flies on along a new path, and what it can hit from there is foreseen anew. Several
/// resolvers can work side by side, each on a tile: what a resolver may not touch (TileReach) it leaves.
template <class Real>
class ImpactResolver {
  public:
    ImpactResolver();

    std::size_t budget = 0;  ///< impacts that may still be carried out

    /// Before the first phase nothing is carried out, after the last one everything.
    static constexpr std::size_t kBeforeAll = SIZE_MAX, kAfterAll = SIZE_MAX - 1;

    /// @param books  the flights', or the outcome's own
    void begin_substep(const Flights<Real>& flights, const ImpactTerms<Real>& terms, ImpactOutcome& outcome,
                       Books& books);
    /// Empties the calendar for `expected` impacts of a tile, or of all of the plane.
    void begin_phase(std::size_t phase, const TileReach& reach, std::size_t expected);
    void add(const Impact& impact) { calendar_.push(impact); }
    /// Carries out what is in the calendar, and what comes of it.
    void resolve();
    /// What is still in the calendar, into `left`.
    void leave_rest();
    std::size_t waiting() const { return calendar_.size(); }

    /// When the bodies of a meeting next touch, from clock `from` on.
    double impact_time(Meeting m, double from) const;
    /// Puts the next impact of a meeting, if there is one from clock `from` on, into the calendar, or into
    /// the list of other tiles.
    void foresee(Meeting m, double from);
    /// Foresees what a body can hit after it was deflected at clock `from`.
    void foresee_all_of(std::int32_t row, double from);
    void foresee_near(std::int32_t row, double from);
    void push(Meeting m, double s, std::size_t tile);
    /// Asks the memory for all that the impacts of a tile will touch. Without, each waits for some twenty
    /// cache lines.
    void prefetch_tile(std::size_t tile) const;
    /// A contact to be looked at first in the next substep.
    void keep_resting(Meeting m, double force);

    std::size_t bytes() const;

  private:
    double time_at_wall(std::int32_t row, const Flight& f, std::int32_t side, double from) const;
    double time_of_pair(Meeting m, const Flight& fa, const Flight& fb, double from) const;
    void queue(Meeting m, double from, double s);
    void foresee_walls(std::int32_t row, double from);
    std::size_t keep_touchable(std::int32_t row, std::size_t found);
    bool may_look(double y, Real reach) const { return reach_.is_unbounded() || may_look_near(y, reach); }
    bool may_carry_out(Meeting m) const { return reach_.is_unbounded() || may_move_all_of(m); }
    bool may_look_near(double y, Real reach) const;
    bool may_move_all_of(Meeting m) const;
    void prefetch_margins(Meeting m) const;
    void take_simultaneous(const Impact& first);
    void carry_out(const Impact& impact);
    void carry_out_together();
    void note_impact(Meeting m, const Encounter& e);
    double restitution_of(Meeting m, const Encounter& e) const;
    double approach_noise(Meeting m) const;
    bool is_foreseen_rightly(const Impact& impact) const;

    Flights<Real> flights_;
    ImpactTerms<Real> terms_;
    ImpactOutcome* out_ = nullptr;
    ImpactCalendar calendar_;
    std::size_t phase_ = kBeforeAll;
    TileReach reach_;
    std::vector<Impact> simultaneous_;
    SimultaneousImpacts<Real> together_;
    std::vector<std::int32_t> moved_;
    Column<std::int32_t> near_;
};

extern template class ImpactResolver<float>;
extern template class ImpactResolver<double>;

}  // namespace carom

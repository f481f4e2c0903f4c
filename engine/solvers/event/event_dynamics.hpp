#pragma once

#include <optional>
#include <span>
#include <vector>

#include "parallel/interruption.hpp"
#include "solvers/event/event_cells.hpp"
#include "solvers/event/event_impacts.hpp"
#include "solvers/event/event_queue.hpp"
#include "solvers/event/event_store.hpp"

namespace carom {

/// Solver `event`: event-driven dynamics of hard discs between walls, under one gravity. Nothing happens
/// between impacts but flight that is known exactly, so the solver goes from impact to impact; there is no
/// step length and no error but round-off.
///
/// Every disc has a clock of its own: its path is stated where its last impact was and touched again only at
/// the next. It foresees one event, the earlier of an impact and of leaving its cell of a grid, and one queue
/// says whose comes first. An impact foreseen with a partner that has been deflected since is void; the disc
/// then looks anew. All arithmetic is in double precision.
///
/// The rule against inelastic collapse (`kCollapseFraction`): a disc that is hit again within the contact
/// time bounces elastically, and leaves what it falls back on fast enough to stay away for that long. So
/// every disc has a bounded number of dissipating impacts a second, and a disc that should rest shivers by
/// g t_c²/8 instead: 1e-9 of a radius.
///
/// Cost: O(log discs) an impact, in practice constant until the discs outgrow the caches. 184 to 192 bytes
/// a disc (docs/decisions/0005-event-solver.md).
/// Source: Lubachevsky, "How to simulate billiards and similar systems", J. Comput. Phys. 94 (1991): one
/// event a disc, delayed states; Alder & Wainwright (1959).
class EventDynamics {
  public:
    /// Takes bodies and laws; row i of `bodies` is row i of all answers. Sets the clock to zero.
    /// Cost: O(bodies log bodies).
    void load(std::span<const EventBody> bodies, const EventLaws& laws);

    /// The first two bodies by row, or body and wall, that overlap by more than a fraction of the smaller
    /// radius.
    struct Overlap {
        std::int32_t a, b;  ///< rows, a < b; or b = -1 - side of the walls
        double separation;  ///< m
    };
    std::optional<Overlap> find_overlap(double fraction) const;

    /// Carries out everything within the next `duration` [s]. Nothing but round-off depends on where it
    /// stops: the same impacts at the same times follow, whatever the stops in between.
    /// @param interruption  of the step; asked after each event; it ends, too, if there are more impacts
    /// than most_impacts()
    /// @return s, until where it came: the whole duration, or the time of the event that was next
    double advance(double duration, Interruption& interruption);
    /// The same where nothing interrupts it.
    double advance(double duration) {
        Interruption none;
        return advance(duration, none);
    }
    /// Whether the last advance() ended because it had more than most_impacts().
    bool has_given_up() const { return impacts_left_ < 0; }

    /// Impacts that are carried out in one call of advance(): a million, and ten thousand for each disc that
    /// can move.
    std::int64_t most_impacts() const;

    /// Those that had most of the last impacts of an advance() that gave up: rows, most first.
    struct Busiest {
        std::int64_t impacts = 0;  ///< how many the last are
        struct Side {
            std::int32_t row;      ///< or -1 - side of the walls
            std::int64_t impacts;  ///< of these
        };
        std::vector<Side> sides;
    };
    Busiest find_busiest() const;

    struct State {
        Vec2 position, velocity;
        double angle, spin;
    };
    /// State of a body at the present time of the clock.
    State state(std::size_t row) const;

    const EventCounters& counters() const { return counters_; }
    double contact_time() const { return impacts_.rule.contact_time; }  ///< s, of the collapse rule
    void keep_books(Books* books) { impacts_.books = books; }
    std::size_t bytes() const;

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.store_, self.cells_, self.queue_, self.impacts_, self.counters_, self.is_involved_);
        archive(self.time_, self.same_instant_, self.longest_clock_, self.cell_radius_, self.sorted_at_);
        if constexpr (!std::is_const_v<Self>) self.impacts_.counters = &self.counters_;
    }

  private:
    struct Earliest;
    struct Path {  ///< of a disc from now on
        Vec2 position, velocity;
        double now;
    };

    bool run_until(double time, Interruption& interruption);
    bool count_impact(std::size_t disc);
    void restart_clock();
    void set_scales();
    double find_cell_radius(Vec2 box) const;
    void arrange();
    void sort_discs(std::span<const Vec2> positions);

    /// Calls visit(other) for every disc but itself that a disc may meet before it leaves its cell.
    template <class Visit>
    void for_each_neighbour(std::size_t disc, const Visit& visit) const {
        const auto see = [&](std::size_t other) {
            if (other != disc && !(store_.is_immovable(disc) && store_.is_immovable(other))) visit(other);
        };
        if (store_.is_large(disc)) {
            for (std::size_t other = 0; other < store_.count(); ++other) see(other);
            return;
        }
        const EventMover& mover = store_.movers[disc];
        cells_.for_each_around(store_.movers.span(), mover.cell_x, mover.cell_y,
                               [&](std::int32_t other) { see(static_cast<std::size_t>(other)); });
        for (std::size_t other = store_.large_begin; other < store_.large_end; ++other) see(other);
    }
    /// Calls offer(time, partner) for everything on a disc's path.
    template <class Offer>
    void for_each_meeting(std::size_t disc, const Path& path, const Offer& offer);
    double meeting_time(std::size_t disc, const Path& path, std::size_t other);

    void forecast(std::size_t disc, double now);
    void set_exit(std::size_t disc, const Path& path);
    void cross(std::size_t disc, double now);
    bool is_void(const EventForecast& forecast) const;
    void impact(std::size_t disc, double now);
    void impact_together(std::size_t disc, double now);
    void carry_out_alone(std::size_t disc, EventContact& contact, double now);
    bool is_still_apart(const EventContact& contact, double now) const;
    EventContact contact_of(std::size_t disc, std::int32_t partner, double now) const;
    void involve(std::int32_t disc);
    void add_contact(std::size_t disc, std::int32_t partner, double now);

    EventStore store_;
    EventCells cells_;
    EventQueue queue_;
    EventImpacts impacts_;
    EventCounters counters_;
    std::vector<EventContact> contacts_;     // at one instant
    std::vector<std::int32_t> involved_;     // in them
    std::vector<std::uint8_t> is_involved_;  // [discs]
    double time_ = 0;                        // s, where run_until stopped; on the clock
    double same_instant_ = 0;                // s
    double longest_clock_ = 0;               // s
    double cell_radius_ = 0;                 // m, the largest that is not "large"
    std::int64_t sorted_at_ = 0;             // impacts when the discs were last sorted
    std::int64_t impacts_left_ = 0;          // of this advance
    std::vector<std::int64_t> tally_;        // [rows, then walls], of the last impacts before it gives up
};

}  // namespace carom

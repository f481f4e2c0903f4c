#include "solver/impulse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solver/impact_time.hpp"
#include "solver/separate_overlaps.hpp"

namespace carom {
namespace {

// Approaches slower than this part of what gravity adds in a substep do not bounce: the last bounces of a
// ball, whose number is infinite, end here. A bouncing ball then makes at most 1 / (2 kRestFraction) bounces
// a substep and comes to rest early by 2 kRestFraction h / (1 - e).
constexpr double kRestFraction = 0.02;

// A contact that stopped bouncing inside a substep falls freely for the rest of it. At the next one it is
// known as resting up to the speed that this can have given it.
constexpr double kPersistingFraction = 1.5;

// Impacts of a substep beyond this many are left to the next one (Profile::unresolved_impacts). Galperin's
// billiard and a ball coming to rest need hundreds for one body; a gas needs less than one a body.
constexpr std::size_t kMostImpacts = 20000;
constexpr std::size_t kMostImpactsPerBody = 64;

// Impacts closer in time than this part of the substep count as simultaneous: above the round-off of Real.
template <class Real>
constexpr double kSameInstant = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-11;

}  // namespace

template <class Real>
void ImpulseSolver<Real>::settle_contacts(std::span<const Meeting> meetings, const Handles& handles) {
    const double dt = flights.end.t;
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    flights.rest_speed = kRestFraction * gravity * flights.end.s;
    deflections_.resize(std::max(deflections_.size(), flights.bodies->count));
    budget_ = kMostImpacts + kMostImpactsPerBody * flights.bodies->count;
    overlaps_.clear(), held_.clear(), queue_.clear();
    at_rest_.clear();

    if (gravity > 0) collect_persisting(handles);
    for (const Meeting& m : meetings) {
        const Encounter e = flights.encounter(m, 0);
        const double radius = flights.smaller_radius(m);
        if (e.separation < -kSlopFraction * radius) overlaps_.push_back(m);
        if (std::fabs(e.normal_velocity) <= flights.rest_speed && e.separation <= kTouchFraction * radius &&
            flights.rest_speed > 0)
            at_rest_.push_back({m, 0});
    }
    if (!overlaps_.empty())
        counters.overlaps_corrected += separate_overlaps(flights, overlaps_, dt, separation_targets_);
    drop_duplicates_at_rest();
    counters.resting_contacts = static_cast<std::int64_t>(at_rest_.size());
    if (!at_rest_.empty()) {
        resting_.hold(flights, at_rest_, held_);
        for (const PressedMeeting& p : at_rest_) keep_resting(p.meeting, p.force);
    }
    for (const Meeting& m : meetings) foresee(m, 0);
}

/// A contact to be looked at first in the next substep.
template <class Real>
void ImpulseSolver<Real>::keep_resting(Meeting m, double force) {
    const auto& id = flights.bodies->id;
    persisting_.push_back({id[static_cast<std::size_t>(m.a)],
                           m.with_wall() ? BodyId{} : id[static_cast<std::size_t>(m.b)],
                           m.with_wall() ? m.b : 0, force});
}

/// Contacts at rest of the last substep that still touch, into the list for this one.
template <class Real>
void ImpulseSolver<Real>::collect_persisting(const Handles& handles) {
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    const double fastest = kPersistingFraction * gravity * flights.end.s;
    for (const RestingContact& c : persisting_) {
        if (!handles.is_alive(c.a) || (c.wall == 0 && !handles.is_alive(c.b))) continue;
        const auto row = [&](BodyId id) { return static_cast<std::int32_t>(handles.row_of_slot(id.index)); };
        const Meeting m = c.wall != 0 ? Meeting{row(c.a), c.wall}
                                      : Meeting{std::min(row(c.a), row(c.b)), std::max(row(c.a), row(c.b))};
        if (m.with_wall() && !flights.has_wall(m.b)) continue;
        const Encounter e = flights.encounter(m, 0);
        const bool touches = e.separation <= kTouchFraction * flights.smaller_radius(m);
        // Also if it moves apart just now: stopping its neighbours can press it together again.
        if (!touches || std::fabs(e.normal_velocity) > fastest) continue;
        at_rest_.push_back({m, c.force});
    }
    persisting_.clear();
}

/// A contact can be known from the last substep, found again, and have been hit several times: the one that
/// carries most stays. In a fixed order.
template <class Real>
void ImpulseSolver<Real>::drop_duplicates_at_rest() {
    const auto key = [](const PressedMeeting& p) { return std::pair(p.meeting.a, p.meeting.b); };
    std::sort(at_rest_.begin(), at_rest_.end(), [&](const PressedMeeting& p, const PressedMeeting& q) {
        return key(p) != key(q) ? key(p) < key(q) : p.force > q.force;
    });
    const auto same = [](const PressedMeeting& p, const PressedMeeting& q) { return p.meeting == q.meeting; };
    at_rest_.erase(std::unique(at_rest_.begin(), at_rest_.end(), same), at_rest_.end());
}

template <class Real>
std::size_t ImpulseSolver<Real>::bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return queue_.bytes() + resting_.bytes() + of(overlaps_) + of(separation_targets_) + of(at_rest_) +
           of(persisting_) + of(held_) + of(simultaneous_) + together_.bytes() + of(moved_) + near_.bytes() +
           of(deflections_) + flights.motion.bytes() + flights.accelerations.bytes();
}

/// Speed below which the approach of two touching surfaces is round-off [m/s].
template <class Real>
double ImpulseSolver<Real>::approach_noise(Meeting m) const {
    constexpr double kUnits = 8;
    const auto speed = [&](std::int32_t row) {
        const Vec2 v = flights.flight(row).velocity;
        return std::fabs(v.x) + std::fabs(v.y);
    };
    return kUnits * std::numeric_limits<Real>::epsilon() * (speed(m.a) + (m.with_wall() ? 0 : speed(m.b)));
}

/// Puts the next impact of a meeting, if there is one from clock `from` on, into the queue.
template <class Real>
void ImpulseSolver<Real>::foresee(Meeting m, double from) {
    const Window window{from, flights.end.s, flights.drag()};
    const Flight fa = flights.flight(m.a);
    double s = kNever;
    if (m.with_wall()) {
        const Vec2 n = Flights<Real>::wall_normal(m.b);
        const double clearance = flights.wall_clearance(m.b, fa.position) - flights.radius(m.a);
        s = wall_impact_time(clearance, -dot(n, fa.velocity), -dot(n, fa.acceleration), window);
    } else {
        const Flight fb = flights.flight(m.b);
        const Flight relative{fb.position - fa.position, fb.velocity - fa.velocity,
                              fb.acceleration - fa.acceleration};
        const double reach = flights.reach(m);
        s = relative.acceleration == Vec2{}
                ? straight_impact_time(relative.position + from * relative.velocity, relative.velocity, reach,
                                       window)
                : accelerated_impact_time(relative, reach, window,
                                          4 * std::numeric_limits<Real>::epsilon() * reach);
    }
    if (s == kNever) return;
    if (flights.rest_speed > 0 && flights.rests(m, from) && flights.rests(m, s)) {
        keep_resting(m, 0);  // too gentle to bounce from here on
        return;
    }
    queue_.push({s, m, deflections_[static_cast<std::size_t>(m.a)],
                 m.with_wall() ? 0 : deflections_[static_cast<std::size_t>(m.b)]});
}

/// Foresees what a body can hit after it was deflected.
template <class Real>
void ImpulseSolver<Real>::foresee_all_of(std::int32_t row, double from, const Candidates<Real>& candidates) {
    const Flight f = flights.flight(row);
    if (flights.walls) {
        const Vec2 end = position_at(f, flights.end.s, flights.end.q);
        const Vec2 now = position_at(f, from, flight_q(from, flights.drag()));
        for (const std::int32_t side : kWallSides) {
            if (!flights.has_wall(side)) continue;
            // The path bends by no more than a q between its ends.
            const double bend =
                std::fabs(dot(f.acceleration, Flights<Real>::wall_normal(side))) * flights.end.q;
            const double nearest =
                std::fmin(flights.wall_clearance(side, now), flights.wall_clearance(side, end)) - bend;
            if (nearest < flights.radius(row)) foresee({row, side}, from);
        }
    }
    const std::size_t count =
        candidates.find_near(row, position_at(f, flights.end.s, flights.end.q), flights.radius(row), near_);
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t other = near_[i];
        if (other == row) continue;
        if (flights.is_immovable(row) && flights.is_immovable(other)) continue;
        // One order for a pair, whichever of the two asks: the same bits and the same ties.
        foresee(row < other ? Meeting{row, other} : Meeting{other, row}, from);
    }
}

template <class Real>
bool ImpulseSolver<Real>::is_foreseen_rightly(const Impact& i) const {
    return deflections_[static_cast<std::size_t>(i.meeting.a)] == i.deflections_a &&
           (i.meeting.with_wall() || deflections_[static_cast<std::size_t>(i.meeting.b)] == i.deflections_b);
}

/// Pops every valid impact at the instant of the earliest one into `simultaneous_`.
template <class Real>
void ImpulseSolver<Real>::take_simultaneous(double s) {
    const double last = s + kSameInstant<Real> * flights.end.s;
    while (!queue_.is_empty() && queue_.next().s <= last) {
        const Impact impact = queue_.pop();
        if (!is_foreseen_rightly(impact)) continue;
        // Foreseen from both sides, a meeting can be queued twice; equal impacts are neighbours in the
        // queue's order.
        if (!simultaneous_.empty() && simultaneous_.back().meeting == impact.meeting) continue;
        simultaneous_.push_back(impact);
    }
}

template <class Real>
double ImpulseSolver<Real>::restitution_of(Meeting m, const Encounter& e) const {
    return e.normal_velocity > -flights.rest_speed ? 0 : flights.restitution(m);
}

/// Counts an impact; what was foreseen for its bodies is void. One too gentle to bounce rests from now on.
template <class Real>
void ImpulseSolver<Real>::note_impact(Meeting m, const Encounter& e) {
    ++counters.impacts;
    counters.wall_impacts += m.with_wall();
    if (e.normal_velocity > -flights.rest_speed) keep_resting(m, 0);
    const auto note = [&](std::int32_t row) {
        if (flights.is_immovable(row)) return;
        ++deflections_[static_cast<std::size_t>(row)];
        moved_.push_back(row);
    };
    note(m.a);
    if (!m.with_wall()) note(m.b);
}

/// One impact by itself.
template <class Real>
void ImpulseSolver<Real>::carry_out(const Impact& impact) {
    const Meeting m = impact.meeting;
    const Encounter e = flights.encounter(m, impact.s);
    if (!(e.normal_velocity < -approach_noise(m))) return;
    const double restitution = restitution_of(m, e);
    const double j = impact_impulse(e.normal_velocity, restitution, flights.inverse_mass_sum(m));
    flights.apply_impulse(m, e, j, impact.s);
    if (flights.books->is_open)
        flights.books->restitution += impact_work(j, e.normal_velocity, -restitution * e.normal_velocity);
    note_impact(m, e);
}

/// Impacts at one instant.
template <class Real>
void ImpulseSolver<Real>::carry_out_together() {
    together_.clear();
    for (const Impact& i : simultaneous_) {
        const Encounter e = flights.encounter(i.meeting, i.s);
        if (e.normal_velocity < -approach_noise(i.meeting))
            together_.add(flights, i.meeting, e, i.s, -restitution_of(i.meeting, e) * e.normal_velocity);
    }
    together_.carry_out(flights);
    for (const auto& i : together_.impacts())
        if (i.impulse > 0) note_impact(i.meeting, i.encounter);
    counters.simultaneous_impacts += static_cast<std::int64_t>(together_.impacts().size());
}

template <class Real>
void ImpulseSolver<Real>::resolve_impacts(const Candidates<Real>& candidates) {
    while (!queue_.is_empty()) {
        const Impact first = queue_.pop();
        if (!is_foreseen_rightly(first)) continue;
        if (budget_ == 0) {
            counters.unresolved_impacts += static_cast<std::int64_t>(queue_.size()) + 1;
            queue_.clear();
            return;
        }
        --budget_;
        moved_.clear(), simultaneous_.assign(1, first);
        take_simultaneous(first.s);
        if (simultaneous_.size() == 1)
            carry_out(first);
        else
            carry_out_together();
        std::sort(moved_.begin(), moved_.end());
        moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
        for (const std::int32_t row : moved_) foresee_all_of(row, first.s, candidates);
    }
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace carom

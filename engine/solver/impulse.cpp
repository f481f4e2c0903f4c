#include "solver/impulse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/prefetch.hpp"
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

// Room in every list from the start, so that a small world soon has met its busiest step; lists double from
// there.
constexpr std::size_t kRoomAtStart = 256;

// Meetings are looked at in the order of the plane, which memory follows if told a little ahead.
constexpr std::size_t kMeetingsAhead = 8;

// A tile's share of what impacts touch, some 60 bytes a body, about fits into a second-level cache of 1 MiB.
// Its side is in cells of the grid, which hold one to two bodies in a gas.
constexpr std::size_t kBodiesOfTile = 16384;
constexpr std::size_t kTileCells = 112;

// Impacts closer in time than this part of the substep count as simultaneous: above the round-off of Real.
template <class Real>
constexpr double kSameInstant = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-11;

}  // namespace

template <class Real>
ImpulseSolver<Real>::ImpulseSolver() {
    for (auto* list : {&held_, &moved_}) list->reserve(kRoomAtStart);
    overlaps_.reserve(kRoomAtStart), separation_targets_.reserve(kRoomAtStart),
        at_rest_.reserve(kRoomAtStart);
    persisting_.reserve(kRoomAtStart), simultaneous_.reserve(kRoomAtStart);
    together_.reserve(kRoomAtStart), resting_.reserve(kRoomAtStart), queue_.reserve(kRoomAtStart);
}

template <class Real>
void ImpulseSolver<Real>::settle_contacts(std::span<const Meeting> meetings, const Handles& handles,
                                          const Candidates<Real>& candidates, double slack,
                                          const KernelTable<Real>& kernels) {
    slack_ = slack, kernels_ = &kernels;
    const double dt = flights.end.t;
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    flights.rest_speed = kRestFraction * gravity * flights.end.s;
    deflections_.resize(std::max(deflections_.size(), flights.bodies->count));
    budget_ = kMostImpacts + kMostImpactsPerBody * flights.bodies->count;
    overlaps_.clear(), held_.clear();
    tiles_a_side_ = 1;
    while (tiles_a_side_ * tiles_a_side_ * kBodiesOfTile < flights.bodies->count) ++tiles_a_side_;
    candidates_ = &candidates;
    queue_.start(flights.end.s, meetings.size(), tiles_a_side_ * tiles_a_side_);
    at_rest_.clear();

    if (gravity > 0) collect_persisting(handles);
    const auto prefetch_ahead = [&](std::size_t i) {
        if (i + kMeetingsAhead < meetings.size()) prefetch_meeting(meetings[i + kMeetingsAhead]);
    };
    for (std::size_t i = 0; i < meetings.size(); ++i) {
        prefetch_ahead(i);
        sort_out(meetings[i]);
    }
    if (!overlaps_.empty())
        counters.overlaps_corrected += separate_overlaps(flights, overlaps_, dt, separation_targets_);
    drop_duplicates_at_rest();
    counters.resting_contacts = static_cast<std::int64_t>(at_rest_.size());
    if (!at_rest_.empty()) {
        resting_.hold(flights, at_rest_, held_);
        for (const PressedMeeting& p : at_rest_) keep_resting(p.meeting, p.force);
    }
    for (std::size_t i = 0; i < meetings.size(); ++i) {
        prefetch_ahead(i);
        foresee(meetings[i], 0);
    }
    overshoot_ = candidates.overshoot();
    for (const std::int32_t row : candidates.strays()) foresee_near(row, 0, candidates);
}

/// Lists a meeting that overlaps or rests at the start of the substep.
template <class Real>
void ImpulseSolver<Real>::sort_out(Meeting m) {
    const double radius = flights.smaller_radius(m);
    if (!m.with_wall() && !(flights.rest_speed > 0)) {  // the usual case needs no root
        const Vec2 d = flights.flight(m.b).position - flights.flight(m.a).position;
        const double overlapping = flights.reach(m) - kSlopFraction * radius;
        if (length_squared(d) < overlapping * overlapping) overlaps_.push_back(m);
        return;
    }
    const Encounter e = flights.encounter(m, 0);
    if (e.separation < -kSlopFraction * radius) overlaps_.push_back(m);
    const bool is_slow = std::fabs(e.normal_velocity) <= flights.rest_speed && flights.rest_speed > 0;
    if (is_slow && e.separation <= std::fmin(kTouchFraction * radius, rest_height(m)))
        at_rest_.push_back({m, 0});
}

/// Separation of two surfaces from which they meet at the rest speed, or that is round-off [m]: what is
/// farther apart, at the top of a small bounce, is going to bounce again.
template <class Real>
double ImpulseSolver<Real>::rest_height(Meeting m) const {
    constexpr double kUnits = 8;
    const Vec2 x = flights.flight(m.a).position;
    const double noise =
        kUnits * std::numeric_limits<Real>::epsilon() * (std::fabs(x.x) + std::fabs(x.y) + flights.reach(m));
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    return std::fmax(0.5 * flights.rest_speed * flights.rest_speed / gravity, noise);
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
    const Flight fa = flights.flight(m.a);
    const double s =
        m.with_wall() ? time_at_wall(m.a, fa, m.b, from) : time_of_pair(m, fa, flights.flight(m.b), from);
    if (s != kNever) queue(m, from, s);
}

template <class Real>
double ImpulseSolver<Real>::time_at_wall(std::int32_t row, const Flight& f, std::int32_t side,
                                         double from) const {
    const Vec2 n = Flights<Real>::wall_normal(side);
    const double clearance = flights.wall_clearance(side, f.position) - flights.radius(row);
    return wall_impact_time(clearance, -dot(n, f.velocity), -dot(n, f.acceleration),
                            {from, flights.end.s, flights.drag()});
}

template <class Real>
double ImpulseSolver<Real>::time_of_pair(Meeting m, const Flight& fa, const Flight& fb, double from) const {
    const Window window{from, flights.end.s, flights.drag()};
    const Flight relative{fb.position - fa.position, fb.velocity - fa.velocity,
                          fb.acceleration - fa.acceleration};
    if (relative.acceleration == Vec2{}) {
        const Vec2 d = relative.position + from * relative.velocity;
        if (!(dot(d, relative.velocity) < 0)) return kNever;  // most: worth asking first
        return straight_impact_time(d, relative.velocity, flights.reach(m), window);
    }
    const double reach = flights.reach(m);
    return accelerated_impact_time(relative, reach, window, 4 * std::numeric_limits<Real>::epsilon() * reach);
}

template <class Real>
void ImpulseSolver<Real>::queue(Meeting m, double from, double s) {
    if (flights.rest_speed > 0 && flights.rests(m, from) && flights.rests(m, s)) {
        keep_resting(m, 0);  // too gentle to bounce from here on
        return;
    }
    queue_.push({s, m, deflections_[static_cast<std::size_t>(m.a)],
                 m.with_wall() ? 0 : deflections_[static_cast<std::size_t>(m.b)]},
                tile_of(m.a));
}

/// The queue's tile that a body is in: a block of the grid, numbered on a torus.
template <class Real>
std::size_t ImpulseSolver<Real>::tile_of(std::int32_t row) const {
    if (tiles_a_side_ == 1) return 0;
    const Vec2 x = flights.flight(row).position;
    const auto block = candidates_->grid().block_of(x.x, x.y, kTileCells);
    return block.v % tiles_a_side_ * tiles_a_side_ + block.u % tiles_a_side_;
}

template <class Real>
void ImpulseSolver<Real>::prefetch_meeting(Meeting m) const {
    const auto prefetch_row = [&](std::int32_t row) {
        prefetch(&flights.motion[static_cast<std::size_t>(row) * Flights<Real>::kMotionWidth]);
        prefetch(&deflections_[static_cast<std::size_t>(row)]);
    };
    prefetch_row(m.a);
    if (!m.with_wall()) prefetch_row(m.b);
}

/// Asks the memory for all that the impacts of a tile will touch. Without, each waits for some thirty cache
/// lines.
template <class Real>
void ImpulseSolver<Real>::prefetch_tile(std::size_t tile) const {
    const auto& grid = candidates_->grid();
    const auto counts = grid.block_counts(kTileCells);
    if (counts.u > tiles_a_side_ || counts.v > tiles_a_side_) return;  // more than one block of that number
    const auto prefetch_rows = [&](std::span<const std::int32_t> rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto row = static_cast<std::size_t>(rows[i]);
            prefetch(&flights.motion[row * Flights<Real>::kMotionWidth]);
            if (i % 8 != 0) continue;  // neighbours in the plane are nearly neighbours in the columns
            prefetch(&deflections_[row]);
            prefetch(&grid.built_x()[row]);
            prefetch(&grid.built_y()[row]);
            prefetch(&candidates_->reach()[row]);
        }
    };
    grid.prefetch_block({tile % tiles_a_side_, tile / tiles_a_side_}, kTileCells, prefetch_rows);
}

/// Foresees what a body can hit after it was deflected at clock `from`.
template <class Real>
void ImpulseSolver<Real>::foresee_all_of(std::int32_t row, double from, const Candidates<Real>& candidates) {
    if (flights.walls) foresee_walls(row, from);
    const Vec2 end = position_at(flights.flight(row), flights.end.s, flights.end.q);
    overshoot_ = std::max(overshoot_, candidates.overshoot_of(row, flights.radius(row), end));
    foresee_near(row, from, candidates);
}

template <class Real>
void ImpulseSolver<Real>::foresee_walls(std::int32_t row, double from) {
    const Flight f = flights.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights.drag()));
    const Vec2 end = position_at(f, flights.end.s, flights.end.q);
    // The path bends by no more than a q between its ends.
    const double x = flights.radius(row) + std::fabs(f.acceleration.x) * flights.end.q;
    const double y = flights.radius(row) + std::fabs(f.acceleration.y) * flights.end.q;
    const Walls& walls = *flights.walls;
    const auto look_at = [&](std::int32_t side, bool is_near) {
        if (!is_near || !flights.has_wall(side)) return;
        const double s = time_at_wall(row, f, side, from);
        if (s != kNever) queue({row, side}, from, s);
    };
    look_at(kLeft, std::min(now.x, end.x) - x < walls.min.x);
    look_at(kRight, std::max(now.x, end.x) + x > walls.max.x);
    look_at(kBottom, std::min(now.y, end.y) - y < walls.min.y);
    look_at(kTop, std::max(now.y, end.y) + y > walls.max.y);
}

/// Foresees what other bodies a body can hit from clock `from` on.
template <class Real>
void ImpulseSolver<Real>::foresee_near(std::int32_t row, double from, const Candidates<Real>& candidates) {
    const Flight f = flights.flight(row);
    const Vec2 now = position_at(f, from, flight_q(from, flights.drag()));
    const Vec2 way = position_at(f, flights.end.s, flights.end.q) - now;
    // No point of the path is farther from `now` than this; others stay within their margins and the
    // overshoot.
    const double travel = std::fabs(way.x) + std::fabs(way.y) +
                          (std::fabs(f.acceleration.x) + std::fabs(f.acceleration.y)) * flights.end.q;
    const std::size_t count = candidates.find_near(now, flights.radius(row) + travel + overshoot_, near_);
    for (std::size_t n = count; n < padded(count); ++n) near_[n] = row;  // which never meets itself
    const auto real = [](double value) { return static_cast<Real>(value); };
    const FindImpactsOf<Real> k{flights.motion.data(),
                                near_.data(),
                                padded(count),
                                row,
                                flights.bodies->radius.data(),
                                flights.bodies->radius.uniform_value(),
                                real(from),
                                real(flights.end.s),
                                real(slack_),
                                near_.data()};
    const std::size_t found = flights.bodies->radius.is_uniform()
                                  ? kernels_->find_impacts_of_uniform_radius(k)
                                  : kernels_->find_impacts_of(k);
    const bool immovable = flights.is_immovable(row);
    for (std::size_t i = 0; i < found; ++i) {
        const std::int32_t other = near_[i];
        if (other == row || (immovable && flights.is_immovable(other))) continue;
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
    const auto on_tile = [&](std::size_t tile) { prefetch_tile(tile); };
    const double last = s + kSameInstant<Real> * flights.end.s;
    while (const Impact* next = queue_.next(on_tile)) {
        if (next->s > last || next->s < s) break;  // earlier ones belong to another tile
        const Impact impact = *next;
        queue_.pop();
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
    const auto on_tile = [&](std::size_t tile) { prefetch_tile(tile); };
    while (const Impact* next = queue_.next(on_tile)) {
        const Impact first = *next;
        if (budget_ == 0) {
            counters.unresolved_impacts += static_cast<std::int64_t>(queue_.size());
            return;
        }
        queue_.pop();
        if (!is_foreseen_rightly(first)) continue;
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

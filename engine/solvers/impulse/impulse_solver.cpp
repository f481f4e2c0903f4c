#include "solvers/impulse/impulse_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/prefetch.hpp"
#include "solvers/impulse/separate_overlaps.hpp"

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

}  // namespace

template <class Real>
ImpulseSolver<Real>::ImpulseSolver() {
    for (auto* list : {&held_, &moved_}) list->reserve(kRoomAtStart);
    overlaps_.reserve(kRoomAtStart), separation_targets_.reserve(kRoomAtStart);
    at_rest_.reserve(kRoomAtStart), resting_.reserve(kRoomAtStart);
    outcome_.resting.reserve(kRoomAtStart);
}

template <class Real>
void ImpulseSolver<Real>::begin_substep(const Candidates<Real>& candidates, double slack,
                                        const KernelTable<Real>& kernels) {
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    flights.rest_speed = kRestFraction * gravity * flights.end.s;
    const std::size_t rows = flights.bodies->count;
    deflections_.resize(std::max(deflections_.size(), rows));
    place_of_row_.resize(std::max(place_of_row_.size(), rows), -1);
    tiles_.begin(candidates.grid(), flights.bodies->moving());
    terms_ = {&candidates, &kernels, &tiles_, deflections_, place_of_row_, slack};
    outcome_.begin(candidates.overshoot());
    all_.begin_substep(flights, terms_, outcome_, *flights.books);
    all_.budget = kMostImpacts + kMostImpactsPerBody * rows;
}

template <class Real>
FoundMeeting ImpulseSolver<Real>::examine(Meeting m) const {
    FoundMeeting found{m};
    if (flights.rest_speed > 0) return found;
    const double slop = kSlopFraction * flights.smaller_radius(m);
    if (m.with_wall()) {
        found.overlaps = flights.encounter(m, 0).separation < -slop;
    } else {  // needs no root
        const Vec2 d = flights.flight(m.b).position - flights.flight(m.a).position;
        const double overlapping = flights.reach(m) - slop;
        found.overlaps = length_squared(d) < overlapping * overlapping;
    }
    found.impact = all_.impact_time(m, 0);
    if (found.impact != kNever)
        found.tile = static_cast<std::uint32_t>(tiles_.tile_of(flights.flight(m.a).position));
    return found;
}

template <class Real>
void ImpulseSolver<Real>::settle_contacts(const FoundMeetings& found, const Handles& handles) {
    overlaps_.clear(), held_.clear(), at_rest_.clear();
    if (tiles_.count() == 1) all_.begin_phase(ImpactResolver<Real>::kAfterAll, {}, found.size());
    if (flights.rest_speed > 0)
        settle_with_rest(found, handles);
    else
        take_examined(found);
    counters.resting_contacts = static_cast<std::int64_t>(at_rest_.size());
    for (const std::int32_t row : terms_.candidates->strays()) all_.foresee_near(row, 0);
}

/// Takes over meetings that were examined when their motion was in the cache, which is done where nothing can
/// rest.
template <class Real>
void ImpulseSolver<Real>::take_examined(const FoundMeetings& found) {
    found.for_each([&](const FoundMeeting& each, const FoundMeeting* soon) {
        if (soon) {
            prefetch(&deflections_[static_cast<std::size_t>(soon->meeting.a)]);
            if (!soon->meeting.with_wall())
                prefetch(&deflections_[static_cast<std::size_t>(soon->meeting.b)]);
        }
        if (each.overlaps) overlaps_.push_back(each.meeting);
        if (each.impact != kNever) all_.push(each.meeting, each.impact, each.tile);
    });
    if (overlaps_.empty()) return;
    separate();
    foresee_pushed();
}

/// Foresees anew for bodies that were pushed apart: their impacts foreseen before are void.
template <class Real>
void ImpulseSolver<Real>::foresee_pushed() {
    moved_.clear();
    for (const Meeting m : overlaps_) {
        moved_.push_back(m.a);
        if (!m.with_wall()) moved_.push_back(m.b);
    }
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
    for (const std::int32_t row : moved_) ++deflections_[static_cast<std::size_t>(row)];
    for (const std::int32_t row : moved_) all_.foresee_all_of(row, 0);
}

/// Overlaps are pushed apart and contacts at rest held before anything is foreseen.
template <class Real>
void ImpulseSolver<Real>::settle_with_rest(const FoundMeetings& found, const Handles& handles) {
    collect_persisting(handles);
    found.for_each([&](const FoundMeeting& each, const FoundMeeting* soon) {
        if (soon) prefetch_meeting(soon->meeting);
        sort_out(each.meeting);
    });
    if (!overlaps_.empty()) separate();
    drop_duplicates_at_rest();
    if (!at_rest_.empty()) {
        resting_.hold(flights, at_rest_, held_);
        for (const PressedMeeting& p : at_rest_) all_.keep_resting(p.meeting, p.force);
    }
    found.for_each([&](const FoundMeeting& each, const FoundMeeting* soon) {
        if (soon) prefetch_meeting(soon->meeting);
        all_.foresee(each.meeting, 0);
    });
}

template <class Real>
void ImpulseSolver<Real>::separate() {
    counters.overlaps_corrected += separate_overlaps(flights, overlaps_, flights.end.t, separation_targets_);
}

/// Lists a meeting that overlaps or rests at the start of the substep.
template <class Real>
void ImpulseSolver<Real>::sort_out(Meeting m) {
    const double radius = flights.smaller_radius(m);
    const Encounter e = flights.encounter(m, 0);
    if (e.separation < -kSlopFraction * radius) overlaps_.push_back(m);
    const bool is_slow = std::fabs(e.normal_velocity) <= flights.rest_speed;
    if (is_slow && e.separation <= std::fmin(kTouchFraction * radius, rest_height(m)))
        at_rest_.push_back({m, 0});
}

/// Separation of two surfaces from which they meet at the rest speed, or that is round-off [m]: what is
/// farther apart, at the top of a small bounce, is going to bounce again.
template <class Real>
double ImpulseSolver<Real>::rest_height(Meeting m) const {
    constexpr double kUnits = 8;  // in the last place, of the places that are subtracted
    const Vec2 x = flights.flight(m.a).position;
    const double noise =
        kUnits * std::numeric_limits<Real>::epsilon() * (std::fabs(x.x) + std::fabs(x.y) + flights.reach(m));
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    return std::fmax(0.5 * flights.rest_speed * flights.rest_speed / gravity, noise);
}

/// Contacts at rest of the last substep that still touch, into the list for this one.
template <class Real>
void ImpulseSolver<Real>::collect_persisting(const Handles& handles) {
    const double gravity = std::sqrt(length_squared(flights.common_acceleration));
    const double fastest = kPersistingFraction * gravity * flights.end.s;
    for (const RestingContact& c : outcome_.resting) {
        if (!handles.is_alive(c.a) || (c.wall == 0 && !handles.is_alive(c.b))) continue;
        const auto row = [&](BodyId id) { return static_cast<std::int32_t>(handles.row_of_slot(id.index)); };
        const Meeting m = c.wall != 0 ? Meeting{row(c.a), c.wall}
                                      : Meeting{std::min(row(c.a), row(c.b)), std::max(row(c.a), row(c.b))};
        if (m.with_wall() && !flights.has_wall(m.b)) continue;
        const Encounter e = flights.encounter(m, 0);
        const bool touches = e.separation <= kTouchFraction * flights.smaller_radius(m);
        // A contact that opens just now is held, too: stopping its neighbours can press it together again.
        if (!touches || std::fabs(e.normal_velocity) > fastest) continue;
        at_rest_.push_back({m, c.force});
    }
    outcome_.resting.clear();
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
    std::size_t bytes = tiles_.bytes() + all_.bytes() + outcome_.bytes() + lists_.bytes() + of(outcomes_) +
                        resolvers_.bytes() + resting_.bytes() + of(overlaps_) + of(separation_targets_) +
                        of(at_rest_) + of(held_) + of(moved_) + of(deflections_) + of(place_of_row_) +
                        columns.bytes();
    for (const ImpactOutcome& outcome : outcomes_) bytes += outcome.bytes();
    return bytes;
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

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace carom

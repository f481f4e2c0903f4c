#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/prefetch.hpp"
#include "solvers/impulse/impacts/impact_resolver.hpp"
#include "solvers/impulse/impacts/rough_impacts.hpp"

// The part of a resolver that carries impacts out, one after the other.

namespace carom {
namespace {

// Impacts closer in time than this part of the substep count as simultaneous: above the round-off of Real.
template <class Real>
constexpr double kSameInstant = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-11;

}  // namespace

/// Room in every list from the start, so that a small world soon has met its busiest step; lists double from
/// there.
template <class Real>
ImpactResolver<Real>::ImpactResolver() {
    constexpr std::size_t kRoomAtStart = 256;
    moved_.reserve(kRoomAtStart), simultaneous_.reserve(kRoomAtStart);
    together_.reserve(kRoomAtStart), calendar_.reserve(kRoomAtStart);
}

template <class Real>
void ImpactResolver<Real>::begin_substep(const Flights<Real>& flights, const ImpactTerms<Real>& terms,
                                         ImpactOutcome& outcome, Books& books) {
    flights_ = flights, terms_ = terms, out_ = &outcome;
    // The embedding program is asked on the thread of the step alone.
    if (&books != flights.books) flights_.books = &books, flights_.interruption = nullptr;
    together_.begin(terms.places);
    phase_ = kBeforeAll, reach_ = {};
}

template <class Real>
void ImpactResolver<Real>::begin_phase(std::size_t phase, const TileReach& reach, std::size_t expected) {
    phase_ = phase, reach_ = reach;
    calendar_.start(flights_.end.s, expected);
}

template <class Real>
void ImpactResolver<Real>::leave_rest() {
    for (; !calendar_.empty(); calendar_.pop()) out_->left.push_back(calendar_.next());
}

template <class Real>
void ImpactResolver<Real>::prefetch_tile(std::size_t tile) const {
    const std::span<const std::int32_t> rows = terms_.tiles->rows(tile, terms_.candidates->grid());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        const auto row = static_cast<std::size_t>(rows[i]);
        prefetch(&flights_.motion[row * Flights<Real>::kMotionWidth]);
        if (i % 8 != 0) continue;  // neighbours in the plane are nearly neighbours in the columns
        prefetch(&terms_.deflections[row]);
        if (flights_.has_friction)
            prefetch(&flights_.bodies->angular_velocity[row]), prefetch(&flights_.bodies->angle[row]);
    }
}

/// Whether this resolver may change what the bodies of a meeting do; what nothing moves is never changed.
template <class Real>
bool ImpactResolver<Real>::may_move_all_of(Meeting m) const {
    const auto may_move = [&](std::int32_t row) {
        const auto place = static_cast<double>(terms_.candidates->built_y()[static_cast<std::size_t>(row)]);
        return reach_.owns(terms_.tiles->line_of(place)) || flights_.is_immovable(row);
    };
    return may_move(m.a) && (m.with_wall() || may_move(m.b));
}

/// Asks for what tells how far the bodies of a coming impact leave their margins.
template <class Real>
void ImpactResolver<Real>::prefetch_margins(Meeting m) const {
    const auto prefetch_row = [&](std::int32_t row) {
        const auto i = static_cast<std::size_t>(row);
        prefetch(&terms_.candidates->built_x()[i]);
        prefetch(&terms_.candidates->built_y()[i]);
        prefetch(&terms_.candidates->reach()[i]);
    };
    prefetch_row(m.a);
    if (!m.with_wall()) prefetch_row(m.b);
}

/// Speed below which the approach of two touching surfaces is round-off [m/s].
template <class Real>
double ImpactResolver<Real>::approach_noise(Meeting m) const {
    constexpr double kUnits = 8;  // in the last place, of the speeds that are subtracted
    const auto speed = [&](std::int32_t row) {
        const Vec2 v = flights_.flight(row).velocity;
        return std::fabs(v.x) + std::fabs(v.y);
    };
    return kUnits * std::numeric_limits<Real>::epsilon() * (speed(m.a) + (m.with_wall() ? 0 : speed(m.b)));
}

template <class Real>
bool ImpactResolver<Real>::is_foreseen_rightly(const Impact& i) const {
    return terms_.deflections[static_cast<std::size_t>(i.meeting.a)] == i.deflections_a &&
           (i.meeting.with_wall() ||
            terms_.deflections[static_cast<std::size_t>(i.meeting.b)] == i.deflections_b);
}

/// Pops every other valid impact at the instant of the earliest one into `simultaneous_`, behind that one; it
/// stays empty if there is none.
template <class Real>
void ImpactResolver<Real>::take_simultaneous(const Impact& first) {
    const double last = first.s + kSameInstant<Real> * flights_.end.s;
    simultaneous_.clear();
    Meeting latest = first.meeting;
    while (!calendar_.empty()) {
        const Impact& next = calendar_.next();
        if (next.s > last || next.s < first.s) return prefetch_margins(next.meeting);
        const Impact impact = next;
        calendar_.pop();
        if (!may_carry_out(impact.meeting)) {
            out_->left.push_back(impact);
            continue;
        }
        // Foreseen from both sides, a meeting can be queued twice; equal impacts are neighbours in the
        // calendar's order.
        if (!is_foreseen_rightly(impact) || impact.meeting == latest) continue;
        latest = impact.meeting;
        if (simultaneous_.empty()) simultaneous_.push_back(first);
        simultaneous_.push_back(impact);
    }
}

template <class Real>
double ImpactResolver<Real>::restitution_of(Meeting m, const Encounter& e) const {
    return e.normal_velocity > -flights_.rest_speed ? 0 : flights_.restitution(m);
}

/// Counts an impact; what was foreseen for its bodies is void. One too gentle to bounce rests from now on.
template <class Real>
void ImpactResolver<Real>::note_impact(Meeting m, const Encounter& e) {
    ++out_->impacts;
    out_->wall_impacts += m.with_wall();
    if (e.normal_velocity > -flights_.rest_speed) keep_resting(m, 0);
    const auto note = [&](std::int32_t row) {
        if (flights_.is_immovable(row)) return;
        ++terms_.deflections[static_cast<std::size_t>(row)];
        moved_.push_back(row);
    };
    note(m.a);
    if (!m.with_wall()) note(m.b);
}

/// One impact by itself.
template <class Real>
void ImpactResolver<Real>::carry_out(const Impact& impact) {
    const Meeting m = impact.meeting;
    const Encounter e = flights_.encounter(m, impact.s);
    if (!(e.normal_velocity < -approach_noise(m))) return;
    const double restitution = restitution_of(m, e);
    const double friction = flights_.has_friction ? flights_.friction(m) : 0;
    if (friction > 0) {
        carry_out_rough(flights_, m, e, {restitution, friction}, impact.s);
        note_impact(m, e);
        return;
    }
    const double j = impact_impulse(e.normal_velocity, restitution, flights_.inverse_mass_sum(m));
    flights_.apply_impulse(m, e, j, impact.s);
    if (flights_.books->is_open)
        flights_.books->restitution += impact_work(j, e.normal_velocity, -restitution * e.normal_velocity);
    note_impact(m, e);
}

/// Impacts at one instant.
template <class Real>
void ImpactResolver<Real>::carry_out_together() {
    together_.clear();
    for (const Impact& i : simultaneous_) {
        const Encounter e = flights_.encounter(i.meeting, i.s);
        if (e.normal_velocity < -approach_noise(i.meeting))
            together_.add(flights_, i.meeting, e, i.s, -restitution_of(i.meeting, e) * e.normal_velocity);
    }
    together_.carry_out(flights_);
    for (const auto& i : together_.impacts())
        if (i.impulse > 0) note_impact(i.meeting, i.encounter);
    out_->simultaneous_impacts += static_cast<std::int64_t>(together_.impacts().size());
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
}

template <class Real>
void ImpactResolver<Real>::resolve() {
    while (!calendar_.empty() && budget > 0) {
        if (flights_.is_interrupted_after(Interruption::kImpact)) return;
        const Impact first = calendar_.next();
        calendar_.pop();
        if (!may_carry_out(first.meeting)) {
            out_->left.push_back(first);
            continue;
        }
        if (!is_foreseen_rightly(first)) continue;
        moved_.clear();
        take_simultaneous(first);
        budget -= std::min(budget, std::max<std::size_t>(simultaneous_.size(), 1));
        if (simultaneous_.empty())
            carry_out(first);
        else
            carry_out_together();
        for (const std::int32_t row : moved_) foresee_all_of(row, first.s);
    }
}

template <class Real>
std::size_t ImpactResolver<Real>::bytes() const {
    const auto of = [](const auto& v) { return v.capacity() * sizeof(v[0]); };
    return calendar_.bytes() + of(simultaneous_) + together_.bytes() + of(moved_) + near_.bytes();
}

template class ImpactResolver<float>;
template class ImpactResolver<double>;

}  // namespace carom

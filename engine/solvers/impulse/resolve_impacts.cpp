#include <algorithm>
#include <cmath>
#include <limits>

#include "simd/prefetch.hpp"
#include "solvers/impulse/impulse_solver.hpp"
#include "solvers/impulse/rough_impacts.hpp"

// The part of the impulse solver that carries impacts out, one after the other.

namespace carom {
namespace {

// Impacts closer in time than this part of the substep count as simultaneous: above the round-off of Real.
template <class Real>
constexpr double kSameInstant = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-11;

}  // namespace

/// Asks the memory for all that the impacts of a tile will touch. Without, each waits for some twenty cache
/// lines.
template <class Real>
void ImpulseSolver<Real>::prefetch_tile(std::size_t tile) const {
    const auto& grid = candidates_->grid();
    tiles_.prefetch(tile, grid, [&](std::span<const std::int32_t> rows) {
        for (std::size_t i = 0; i < rows.size(); ++i) {
            const auto row = static_cast<std::size_t>(rows[i]);
            prefetch(&flights.motion[row * Flights<Real>::kMotionWidth]);
            if (i % 8 != 0) continue;  // neighbours in the plane are nearly neighbours in the columns
            prefetch(&deflections_[row]);
            if (flights.has_friction)
                prefetch(&flights.bodies->angular_velocity[row]), prefetch(&flights.bodies->angle[row]);
        }
    });
}

/// Asks for what tells how far the bodies of a coming impact leave their margins.
template <class Real>
void ImpulseSolver<Real>::prefetch_margins(Meeting m) const {
    const auto prefetch_row = [&](std::int32_t row) {
        const auto i = static_cast<std::size_t>(row);
        prefetch(&candidates_->built_x()[i]);
        prefetch(&candidates_->built_y()[i]);
        prefetch(&candidates_->reach()[i]);
    };
    prefetch_row(m.a);
    if (!m.with_wall()) prefetch_row(m.b);
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

template <class Real>
bool ImpulseSolver<Real>::is_foreseen_rightly(const Impact& i) const {
    return deflections_[static_cast<std::size_t>(i.meeting.a)] == i.deflections_a &&
           (i.meeting.with_wall() || deflections_[static_cast<std::size_t>(i.meeting.b)] == i.deflections_b);
}

/// Pops every other valid impact at the instant of the earliest one into `simultaneous_`, behind that one; it
/// stays empty if there is none.
template <class Real>
void ImpulseSolver<Real>::take_simultaneous(const Impact& first) {
    const auto on_tile = [&](std::size_t tile) { prefetch_tile(tile); };
    const double last = first.s + kSameInstant<Real> * flights.end.s;
    simultaneous_.clear();
    Meeting latest = first.meeting;
    while (const Impact* next = queue_.next(on_tile)) {
        if (next->s > last || next->s < first.s) {  // earlier ones belong to another tile
            prefetch_margins(next->meeting);
            return;
        }
        const Impact impact = *next;
        queue_.pop();
        // Foreseen from both sides, a meeting can be queued twice; equal impacts are neighbours in the
        // queue's order.
        if (!is_foreseen_rightly(impact) || impact.meeting == latest) continue;
        latest = impact.meeting;
        if (simultaneous_.empty()) simultaneous_.push_back(first);
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
    const double friction = flights.has_friction ? flights.friction(m) : 0;
    if (friction > 0) {
        carry_out_rough(flights, m, e, {restitution, friction}, impact.s);
        note_impact(m, e);
        return;
    }
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
    std::sort(moved_.begin(), moved_.end());
    moved_.erase(std::unique(moved_.begin(), moved_.end()), moved_.end());
}

template <class Real>
void ImpulseSolver<Real>::resolve_impacts() {
    const auto on_tile = [&](std::size_t tile) { prefetch_tile(tile); };
    while (const Impact* next = queue_.next(on_tile)) {
        if (flights.is_interrupted_after(Interruption::kImpact)) return;
        const Impact first = *next;
        if (budget_ == 0) {
            counters.unresolved_impacts += static_cast<std::int64_t>(queue_.size());
            return;
        }
        queue_.pop();
        if (!is_foreseen_rightly(first)) continue;
        moved_.clear();
        take_simultaneous(first);
        budget_ -= std::min(budget_, std::max<std::size_t>(simultaneous_.size(), 1));
        if (simultaneous_.empty())
            carry_out(first);
        else
            carry_out_together();
        for (const std::int32_t row : moved_) foresee_all_of(row, first.s);
    }
}

template class ImpulseSolver<float>;
template class ImpulseSolver<double>;

}  // namespace carom

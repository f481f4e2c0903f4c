#include "solvers/impulse/impacts/simultaneous_impacts.hpp"

#include <cmath>

#include "solvers/impulse/impacts/impact_sides.hpp"
#include "solvers/impulse/impacts/rough_impacts.hpp"

namespace carom {
namespace {

// Sweeps end when no impulse changes a velocity by more than this part of the fastest approach.
constexpr int kMostSweepsOfImpacts = 1000;
constexpr double kConvergedInImpacts = 1e-15;

constexpr std::int32_t kNoRow = -1;

}  // namespace

/// Index of a body among those that take part. What nothing moves has one for each impact, as it changes by
/// none of them.
template <class Real>
std::size_t SimultaneousImpacts<Real>::place_of(const Flights<Real>& flights, std::int32_t row) {
    if (flights.is_immovable(row)) {
        changes_.push_back({kNoRow, flights.record_at_rest(row)});
        return changes_.size() - 1;
    }
    std::int32_t& place = place_of_row_[static_cast<std::size_t>(row)];
    if (place < 0) {
        place = static_cast<std::int32_t>(changes_.size());
        changes_.push_back({row, flights.record_at_rest(row)});
    }
    return static_cast<std::size_t>(place);
}

template <class Real>
void SimultaneousImpacts<Real>::add(const Flights<Real>& flights, Meeting m, const Encounter& e, double s,
                                    double target) {
    const std::size_t a = place_of(flights, m.a);
    const std::size_t b = m.with_wall() ? a : place_of(flights, m.b);
    impacts_.push_back({m, e, s, target, 0, e.normal_velocity, flights.inverse_mass_sum(m), a, b});
    if (flights.has_friction) measure_slip(flights, impacts_.back());
    has_friction_ = has_friction_ || impacts_.back().friction > 0;
}

template <class Real>
void SimultaneousImpacts<Real>::measure_slip(const Flights<Real>& flights, Impact& i) const {
    i.friction = flights.friction(i.meeting);
    if (!(i.friction > 0)) return;
    const Vec2 n = i.encounter.normal;
    const auto record = [&](std::int32_t row) { return flights.record(row, i.s); };
    with_sides(i.meeting, record, [&](const auto& a, const auto& b) {
        i.slip = tangent_velocity(a, b, n.x, n.y);
        i.tangent_mass = tangent_mass<kImpacts>(a, b, 1 / inverse_mass(a, b));
    });
}

/// What fn(a, b) says of the changes of both sides of an impact so far.
template <class Real>
template <class Fn>
double SimultaneousImpacts<Real>::with_changes(const Impact& i, const Fn& fn) const {
    const auto change = [&](std::int32_t row) {
        return changes_[row == i.meeting.a ? i.place_a : i.place_b].sum;
    };
    return with_sides(i.meeting, change, fn);
}

template <class Real>
double SimultaneousImpacts<Real>::normal_velocity(const Impact& i) const {
    const Vec2 n = i.encounter.normal;
    return i.encounter.normal_velocity + with_changes(i, [&](const auto& a, const auto& b) {
               return carom::normal_velocity(a, b, n.x, n.y);
           });
}

template <class Real>
double SimultaneousImpacts<Real>::slip(const Impact& i) const {
    const Vec2 n = i.encounter.normal;
    return i.slip +
           with_changes(i, [&](const auto& a, const auto& b) { return tangent_velocity(a, b, n.x, n.y); });
}

template <class Real>
void SimultaneousImpacts<Real>::add_impulses(const Impact& i, const ImpactImpulses& added) {
    const auto add = [&](std::size_t place, double sign) {
        ContactRecord& sum = changes_[place].sum;
        ImpactBody body = body_of(sum);
        body.apply_impulse(added.normal, added.tangent, i.encounter.normal.x, i.encounter.normal.y, sign);
        sum = record_of(body);
    };
    add(i.place_a, -1);
    if (!i.meeting.with_wall()) add(i.place_b, 1);
}

template <class Real>
void SimultaneousImpacts<Real>::solve(const Flights<Real>& flights, double negligible) {
    double fastest = 0;
    for (const Impact& i : impacts_) fastest = std::fmax(fastest, -i.encounter.normal_velocity);
    for (int sweep = 0; sweep < kMostSweepsOfImpacts; ++sweep) {
        if (flights.is_interrupted_after(impacts_.size() * Interruption::kUpdate)) return;
        double largest_change = 0;
        for (Impact& i : impacts_) {
            const double wanted = i.impulse - (normal_velocity(i) - i.target) / i.inverse_mass_sum;
            const ImpulseUpdate<double> normal = push_only(i.impulse, wanted);
            largest_change = std::fmax(largest_change, std::fabs(normal.added) * i.inverse_mass_sum);
            i.impulse = normal.impulse;
            add_impulses(i, {normal.added, 0});
        }
        if (largest_change <= std::fmax(kConvergedInImpacts * fastest, negligible)) break;
    }
}

/// Friction for the normal impulses that were solved before.
template <class Real>
void SimultaneousImpacts<Real>::solve_friction(const Flights<Real>& flights, double negligible) {
    double fastest = 0;
    for (Impact& i : impacts_) {
        i.slip_bounced = slip(i);
        fastest = std::fmax(fastest, std::fmax(-i.encounter.normal_velocity, std::fabs(i.slip_bounced)));
    }
    for (int sweep = 0; sweep < kMostSweepsOfImpacts; ++sweep) {
        if (flights.is_interrupted_after(impacts_.size() * Interruption::kUpdate)) return;
        double largest_change = 0;
        for (Impact& i : impacts_) {
            if (!(i.friction > 0 && i.impulse > 0)) continue;
            const double wanted = i.friction_impulse - i.tangent_mass * slip(i);
            const auto tangent = hold_within(i.friction_impulse, wanted, i.friction * i.impulse);
            largest_change = std::fmax(largest_change, std::fabs(tangent.added) / i.tangent_mass);
            i.friction_impulse = tangent.impulse;
            add_impulses(i, {0, tangent.added});
        }
        if (largest_change <= std::fmax(kConvergedInImpacts * fastest, negligible)) break;
    }
}

template <class Real>
void SimultaneousImpacts<Real>::carry_out(Flights<Real>& flights, double negligible) {
    solve(flights, negligible);
    for (Impact& i : impacts_) i.normal_velocity_after = normal_velocity(i);
    if (has_friction_) solve_friction(flights, negligible);
    for (const Impact& i : impacts_) {
        if (i.impulse == 0) continue;
        if (i.friction_impulse == 0)
            flights.apply_impulse(i.meeting, i.encounter, i.impulse, i.s);
        else
            apply_impulses(flights, i.meeting, i.encounter, {i.impulse, i.friction_impulse}, i.s);
        if (!flights.books->is_open) continue;
        flights.books->restitution +=
            impact_work(i.impulse, i.encounter.normal_velocity, i.normal_velocity_after);
        // Each of the two solves takes energy on its own, so neither books what is the other's.
        if (i.friction_impulse != 0)
            flights.books->friction += impact_work(i.friction_impulse, i.slip_bounced, slip(i));
    }
    for (const VelocityChange& change : changes_)
        if (change.row != kNoRow) place_of_row_[static_cast<std::size_t>(change.row)] = -1;
}

template <class Real>
std::size_t SimultaneousImpacts<Real>::bytes() const {
    return impacts_.capacity() * sizeof(Impact) + changes_.capacity() * sizeof(VelocityChange);
}

template class SimultaneousImpacts<float>;
template class SimultaneousImpacts<double>;

}  // namespace carom

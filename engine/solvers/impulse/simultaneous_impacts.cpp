#include "solvers/impulse/simultaneous_impacts.hpp"

#include <cmath>

#include "constraints/contact_law.hpp"

namespace carom {
namespace {

// Sweeps end when no impulse changes a velocity by more than this part of the fastest approach.
constexpr int kMostSweeps = 1000;
constexpr double kConverged = 1e-15;

}  // namespace

/// Index of a body among those that take part.
template <class Real>
std::size_t SimultaneousImpacts<Real>::place_of(const Flights<Real>& flights, std::int32_t row) {
    std::int32_t& place = place_of_row_[static_cast<std::size_t>(row)];
    if (place < 0) {
        place = static_cast<std::int32_t>(changes_.size());
        changes_.push_back({row, flights.inverse_mass(row), {}});
    }
    return static_cast<std::size_t>(place);
}

template <class Real>
void SimultaneousImpacts<Real>::add(const Flights<Real>& flights, Meeting m, const Encounter& e, double s,
                                    double target) {
    if (place_of_row_.size() < flights.bodies->count) place_of_row_.resize(flights.bodies->count, -1);
    const std::size_t a = place_of(flights, m.a);
    const std::size_t b = m.with_wall() ? a : place_of(flights, m.b);
    impacts_.push_back({m, e, s, target, 0, e.normal_velocity, flights.inverse_mass_sum(m), a, b});
}

template <class Real>
double SimultaneousImpacts<Real>::normal_velocity(const Impact& i) const {
    const Vec2 of_b = i.meeting.with_wall() ? Vec2{} : changes_[i.place_b].change;
    return i.encounter.normal_velocity + dot(of_b - changes_[i.place_a].change, i.encounter.normal);
}

template <class Real>
void SimultaneousImpacts<Real>::solve(double negligible) {
    double fastest = 0;
    for (const Impact& i : impacts_) fastest = std::fmax(fastest, -i.encounter.normal_velocity);
    for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
        double largest_change = 0;
        for (Impact& i : impacts_) {
            const double wanted = i.impulse - (normal_velocity(i) - i.target) / i.inverse_mass_sum;
            const auto [impulse, added] = push_only(i.impulse, wanted);
            const Vec2 change = added * i.encounter.normal;
            largest_change = std::fmax(largest_change, std::fabs(added) * i.inverse_mass_sum);
            i.impulse = impulse;
            VelocityChange& a = changes_[i.place_a];
            a.change -= a.inverse_mass * change;
            if (i.meeting.with_wall()) continue;
            VelocityChange& b = changes_[i.place_b];
            b.change += b.inverse_mass * change;
        }
        if (largest_change <= std::fmax(kConverged * fastest, negligible)) break;
    }
}

template <class Real>
void SimultaneousImpacts<Real>::carry_out(Flights<Real>& flights, double negligible) {
    solve(negligible);
    for (Impact& i : impacts_) i.normal_velocity_after = normal_velocity(i);
    for (const Impact& i : impacts_) {
        if (i.impulse == 0) continue;
        flights.apply_impulse(i.meeting, i.encounter, i.impulse, i.s);
        if (flights.books->is_open)
            flights.books->restitution +=
                impact_work(i.impulse, i.encounter.normal_velocity, i.normal_velocity_after);
    }
    for (const VelocityChange& change : changes_) place_of_row_[static_cast<std::size_t>(change.row)] = -1;
}

template <class Real>
std::size_t SimultaneousImpacts<Real>::bytes() const {
    return impacts_.capacity() * sizeof(Impact) + changes_.capacity() * sizeof(VelocityChange) +
           place_of_row_.capacity() * sizeof(std::int32_t);
}

template class SimultaneousImpacts<float>;
template class SimultaneousImpacts<double>;

}  // namespace carom

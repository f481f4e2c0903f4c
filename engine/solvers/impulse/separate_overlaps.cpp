#include "solvers/impulse/separate_overlaps.hpp"

namespace carom {
namespace {

/// Moves a body by dx before its flight; what that costs against gravity is booked.
template <class Real>
void move(Flights<Real>& flights, std::int32_t row, Vec2 dx) {
    const double inverse_mass = flights.inverse_mass(row);
    if (inverse_mass == 0) return;
    Flight f = flights.flight(row);
    const Vec2 old = f.position;
    f.position += dx;
    flights.store(row, f);
    if (flights.books->is_open) {
        const Vec2 moved = flights.flight(row).position - old;
        flights.books->correction -= dot(flights.common_acceleration, moved) / inverse_mass;
    }
}

}  // namespace

template <class Real>
int separate_overlaps(Flights<Real>& flights, const std::vector<Meeting>& overlaps, double dt,
                      std::vector<double>& targets) {
    targets.clear();
    double depth = 0, mass = 0;  // m, kg: of all overlaps, of all that can be pushed
    for (const Meeting& m : overlaps) {
        const double radius = flights.smaller_radius(m);
        const double separation = flights.encounter(m, 0).separation;
        const double apart = separation + kPushRadiiPerSecond * radius * dt;
        targets.push_back(std::fmin(apart, -kSlopFraction * radius));
        depth -= separation;
        for (const std::int32_t row : {m.a, m.b})
            if (row >= 0 && !flights.is_immovable(row)) mass += 1 / flights.inverse_mass(row);
    }
    // No force says here what lies on what: none of them rises farther than all overlaps together.
    if (flights.books->is_open)
        flights.books->overlap_worth += mass * std::sqrt(length_squared(flights.common_acceleration)) * depth;
    // A tenth of the slop is as good as there: sweeping on would only move round-off.
    constexpr double kCloseEnough = 0.1 * kSlopFraction;
    for (int sweep = 0; sweep < kSeparationSweeps; ++sweep) {
        if (flights.is_interrupted_after(overlaps.size() * Interruption::kUpdate)) return 0;
        bool all_there = true;
        for (std::size_t i = 0; i < overlaps.size(); ++i) {
            const Meeting& m = overlaps[i];
            const Encounter e = flights.encounter(m, 0);
            const double missing = targets[i] - e.separation;
            if (missing <= 0) continue;
            if (missing > kCloseEnough * flights.smaller_radius(m)) all_there = false;
            const double share = missing / flights.inverse_mass_sum(m);
            move(flights, m.a, -share * flights.inverse_mass(m.a) * e.normal);
            if (!m.with_wall()) move(flights, m.b, share * flights.inverse_mass(m.b) * e.normal);
        }
        if (all_there) break;
    }
    return static_cast<int>(overlaps.size());
}

template int separate_overlaps(Flights<float>&, const std::vector<Meeting>&, double, std::vector<double>&);
template int separate_overlaps(Flights<double>&, const std::vector<Meeting>&, double, std::vector<double>&);

}  // namespace carom

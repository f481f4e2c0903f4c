#include <cmath>

#include "stages/stages.hpp"

namespace carom {
namespace {

/// How far different accelerations can bring two paths nearer to each other than the straight lines the
/// kernel looks at [m]: two bodies' worth of fall, as held and static bodies do not fall.
template <class Real>
double slack_of(const Simulation<Real>& sim) {
    const Flights<Real>& flights = sim.solver.flights;
    if (flights.accelerations.empty()) return 0;
    double largest = length_squared(flights.common_acceleration);
    for (const std::int32_t row : sim.world.immovable_rows)
        largest = std::fmax(largest, length_squared(flights.acceleration(row)));
    return 2 * std::sqrt(largest) * flights.end.q;
}

/// Separation up to which the solver wants to see a pair that does not approach: overlaps, and with gravity
/// contacts that may rest. Generous for the smaller of different bodies; the solver looks again.
template <class Real>
double near_of(const Simulation<Real>& sim) {
    const bool may_rest = length_squared(sim.world.gravity) > 0;
    return may_rest ? kTouchFraction * sim.candidates.largest_radius()
                    : -kSlopFraction * sim.candidates.smallest_radius();
}

template <class Real>
void list_wall_meetings(Simulation<Real>& sim, double near) {
    const Flights<Real>& flights = sim.solver.flights;
    sim.wall_rows.for_each_below(sim.world.bodies.count, [&](std::int32_t row) {
        if (flights.is_immovable(row)) return;
        const Flight f = flights.flight(row);
        const Vec2 end = position_at(f, flights.end.s, flights.end.q);
        for (const std::int32_t side : kWallSides) {
            if (!flights.has_wall(side)) continue;
            const double fall =
                std::fabs(dot(Flights<Real>::wall_normal(side), f.acceleration)) * flights.end.q;
            const double nearest =
                std::fmin(flights.wall_clearance(side, f.position), flights.wall_clearance(side, end));
            if (nearest - fall - near < flights.radius(row)) sim.meetings.push_back({row, side});
        }
    });
}

}  // namespace

template <class Real>
void find_impacts(Simulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    const double near = near_of(sim);
    FindImpacts<Real> all{};
    all.motion = sim.solver.flights.motion.data();
    all.a = sim.candidates.pair_a(), all.b = sim.candidates.pair_b();
    all.radius = bodies.radius.data(), all.uniform_radius = bodies.radius.uniform_value();
    all.s = static_cast<Real>(sim.solver.flights.end.s);
    sim.slack = slack_of(sim);
    all.slack = static_cast<Real>(sim.slack);
    all.near = static_cast<Real>(near);
    const auto kernel = all.radius ? sim.kernels->find_impacts : sim.kernels->find_impacts_uniform_radius;
    const std::size_t pairs = sim.candidates.pair_count();
    sim.found_pairs.prepare(pairs, kRowsPerChunk);
    sim.executor.for_each_chunk(pairs, kRowsPerChunk,
                                [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                    FindImpacts<Real> k = all;
                                    k.found = sim.found_pairs.part(chunk);
                                    sim.found_pairs.set_count(chunk, kernel(k, first, padded(last)));
                                });
    sim.meetings.clear();
    sim.found_pairs.for_each_below(pairs, [&](std::int32_t pair) {
        const auto p = static_cast<std::size_t>(pair);
        const std::int32_t a = all.a[p], b = all.b[p];
        sim.meetings.push_back(a < b ? Meeting{a, b} : Meeting{b, a});
    });
    if (sim.world.walls) list_wall_meetings(sim, std::fmax(near, 0));
}

template void find_impacts(Simulation<float>&);
template void find_impacts(Simulation<double>&);

}  // namespace carom

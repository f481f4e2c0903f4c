#include <algorithm>
#include <cmath>

#include "solvers/impulse/stages.hpp"

namespace carom {
namespace {

/// How far different accelerations can bring two paths nearer to each other than the straight lines the
/// kernel looks at [m]: two bodies' worth of fall, as held and static bodies do not fall.
template <class Real>
double slack_of(const ImpulseSimulation<Real>& sim) {
    const Flights<Real>& flights = sim.impulse.flights;
    if (flights.accelerations.empty()) return 0;
    double largest = length_squared(flights.common_acceleration);
    for (const std::int32_t row : sim.world.immovable_rows_below(sim.world.bodies.moving()))
        largest = std::fmax(largest, length_squared(flights.acceleration(row)));
    return 2 * std::sqrt(largest) * flights.end.q;
}

/// Separation up to which the solver wants to see a pair that does not approach: overlaps, and with gravity
/// contacts that may rest. Generous for the smaller of different bodies; the solver looks again.
template <class Real>
double near_of(const ImpulseSimulation<Real>& sim) {
    const bool may_rest = length_squared(sim.world.gravity) > 0;
    return may_rest ? kTouchFraction * sim.candidates.largest_radius()
                    : -kSlopFraction * sim.candidates.smallest_radius();
}

template <class Real>
void list_wall_meetings(ImpulseSimulation<Real>& sim, double near) {
    const Flights<Real>& flights = sim.impulse.flights;
    std::vector<FoundMeeting>& meetings = sim.meetings.lists[sim.meetings.count - 1];
    sim.wall_rows.for_each_below(sim.world.bodies.moving(), [&](std::int32_t row) {
        if (flights.is_immovable(row)) return;
        const Flight f = flights.flight(row);
        const Vec2 end = position_at(f, flights.end.s, flights.end.q);
        for (const std::int32_t side : kWallSides) {
            if (!flights.has_wall(side)) continue;
            const double fall = std::fabs(dot(wall_normal(side), f.acceleration)) * flights.end.q;
            const double nearest = std::fmin(wall_clearance(*flights.walls, side, f.position),
                                             wall_clearance(*flights.walls, side, end));
            if (nearest - fall - near < flights.radius(row))
                meetings.push_back(sim.impulse.examine({row, side}));
        }
    });
}

/// Drops pairs that filters keep apart. @return how many are left
template <class Real>
std::size_t keep_touchable(const Bodies<Real>& bodies, const FindImpacts<Real>& all, std::int32_t* found,
                           std::size_t count) {
    const auto is_apart = [&](std::int32_t pair) {
        const auto p = static_cast<std::size_t>(pair);
        const auto a = static_cast<std::size_t>(all.a[p]), b = static_cast<std::size_t>(all.b[p]);
        return a < bodies.count && b < bodies.count && !bodies.may_touch(a, b);
    };
    return static_cast<std::size_t>(std::remove_if(found, found + count, is_apart) - found);
}

/// Appends those of the pairs [first, last) that may touch, examined while what the kernel has read is in the
/// cache.
template <class Real>
void append_meetings(const ImpulseSimulation<Real>& sim, const FindImpacts<Real>& all, std::size_t first,
                     std::size_t last, std::vector<FoundMeeting>& meetings) {
    std::int32_t found[kRowsPerChunk + kRowPadding];
    FindImpacts<Real> k = all;
    k.found = found;
    const auto kernel = all.radius ? sim.kernels->find_impacts : sim.kernels->find_impacts_uniform_radius;
    std::size_t count = kernel(k, first, padded(last));
    if (sim.world.bodies.has_filters()) count = keep_touchable(sim.world.bodies, all, found, count);
    for (std::size_t n = 0; n < count; ++n) {
        const auto p = static_cast<std::size_t>(found[n]);
        if (p >= last) return;  // padding
        const std::int32_t a = all.a[p], b = all.b[p];
        meetings.push_back(sim.impulse.examine(a < b ? Meeting{a, b} : Meeting{b, a}));
    }
}

template <class Real>
void list_pair_meetings(ImpulseSimulation<Real>& sim, const FindImpacts<Real>& all) {
    const std::size_t pairs = sim.candidates.pair_count();
    const bool is_parallel = sim.executor.is_parallel(pairs);
    const std::size_t chunks = (pairs + kRowsPerChunk - 1) / kRowsPerChunk;
    sim.meetings.count = is_parallel ? chunks : 1;
    if (sim.meetings.lists.size() < sim.meetings.count) sim.meetings.lists.resize(sim.meetings.count);
    for (std::size_t list = 0; list < sim.meetings.count; ++list) sim.meetings.lists[list].clear();
    sim.executor.for_each_chunk(
        pairs, kRowsPerChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
            append_meetings(sim, all, first, last, sim.meetings.lists[is_parallel ? chunk : 0]);
        });
}

}  // namespace

template <class Real>
void find_impacts(ImpulseSimulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    const double near = near_of(sim), slack = slack_of(sim);
    sim.impulse.begin_substep(sim.candidates, slack, *sim.kernels);
    FindImpacts<Real> all{};
    all.motion = sim.impulse.flights.motion.data();
    all.a = sim.candidates.pair_a(), all.b = sim.candidates.pair_b();
    all.radius = bodies.radius.data(), all.uniform_radius = bodies.radius.uniform_value();
    all.s = static_cast<Real>(sim.impulse.flights.end.s);
    all.slack = static_cast<Real>(slack);
    all.near = static_cast<Real>(near);
    list_pair_meetings(sim, all);
    if (sim.world.walls) list_wall_meetings(sim, std::fmax(near, 0));
}

template void find_impacts(ImpulseSimulation<float>&);
template void find_impacts(ImpulseSimulation<double>&);

}  // namespace carom

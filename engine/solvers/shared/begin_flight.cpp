#include <cmath>
#include "shapes/walls.hpp"

#include "solvers/shared/stages.hpp"

namespace carom {
namespace {

// With drag * h below kLargestDragTimesStep, a path bulges beyond its ends by at most max|x''| s²/8 <= .7 |a|
// q.
constexpr double kBendOfFall = 0.7;
/// A body, on one thread: for the executor.
constexpr double kNanosecondsToFly = 1;

/// Accelerations a row, where they can differ: gravity and static bodies, or kinematic bodies and drag.
template <class Real>
void set_accelerations(Simulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    Flights<Real>& flights = sim.impulse.flights;
    flights.common_acceleration = world.gravity;
    const bool can_differ = world.effects.gravity || (world.effects.drag && !world.immovable_rows.empty());
    if (!can_differ || flights.accelerations.size() == world.bodies.count) return;
    flights.accelerations.resize(world.bodies.count);
    for (Vec2& a : flights.accelerations) a = world.gravity;
    for (const std::int32_t row : world.immovable_rows) {
        const auto i = static_cast<std::size_t>(row);
        const Vec2 v{world.bodies.velocity_x[i], world.bodies.velocity_y[i]};
        // x = V t = V s + k V q: steady motion is an acceleration by k V on the clock of things that drag
        // slows.
        flights.accelerations[i] = world.drag.linear * v;
    }
}

template <class Real>
BeginFlight<Real> arguments_of(const Simulation<Real>& sim) {
    const WorldState<Real>& world = sim.world;
    const Bodies<Real>& bodies = world.bodies;
    const FlightClock& end = sim.impulse.flights.end;
    const auto real = [](double value) { return static_cast<Real>(value); };
    BeginFlight<Real> k{};
    k.position_x = bodies.position_x.data(), k.position_y = bodies.position_y.data();
    k.velocity_x = bodies.velocity_x.data(), k.velocity_y = bodies.velocity_y.data();
    const bool built = sim.candidates.is_valid();
    k.built_x = built ? sim.candidates.built_x().data() : k.position_x;
    k.built_y = built ? sim.candidates.built_y().data() : k.position_y;
    k.reach = sim.candidates.reach().data();
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.s = real(end.s);
    k.fall_x = real(world.gravity.x * end.q), k.fall_y = real(world.gravity.y * end.q);
    k.gain_x = real(world.gravity.x * end.s), k.gain_y = real(world.gravity.y * end.s);
    k.bend_x = real(std::fabs(world.gravity.x) * end.q * kBendOfFall);
    k.bend_y = real(std::fabs(world.gravity.y) * end.q * kBendOfFall);
    const bool may_rest = length_squared(world.gravity) > 0;
    k.touch_ratio = real(may_rest ? 1 + kTouchFraction : 1);
    const Enclosure<Real> box(world.walls ? &*world.walls : nullptr);
    k.min_x = box.min_x, k.min_y = box.min_y, k.max_x = box.max_x, k.max_y = box.max_y;
    k.largest_position = real(kLargestPosition), k.largest_speed = real(kLargestSpeed);
    k.motion = const_cast<Real*>(sim.impulse.flights.motion.data());
    return k;
}

/// Takes bodies out whose next state would be no number or beyond the limits, where they are.
template <class Real>
void quarantine_lost(Simulation<Real>& sim) {
    bool any = false;
    sim.lost_rows.for_each_below(sim.world.bodies.count, [&](std::int32_t row) {
        if (sim.world.bodies.is_immovable(static_cast<std::size_t>(row)) &&
            (sim.world.bodies.flags_of(static_cast<std::size_t>(row)) & kKinematic) == 0)
            return;  // static bodies do not fall, though the kernel thinks so
        sim.world.quarantine(static_cast<std::size_t>(row));
        Real* motion = &sim.impulse.flights.motion[static_cast<std::size_t>(row) * 4];
        motion[2] = 0, motion[3] = 0;
        any = true;
    });
    if (any) {
        sim.forget_derived_state();
        set_accelerations(sim);
    }
}

}  // namespace

template <class Real>
void begin_flight(Simulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    Flights<Real>& flights = sim.impulse.flights;
    const std::size_t count = world.bodies.count;
    // Solver `soft` asks only how far bodies may come: drag shortens that, and its step may be long.
    const bool drags = sim.solver != Solver::soft;
    flights.end = flight_clock_at(sim.flight_dt, drags ? world.drag.linear : 0);
    flights.bodies = &world.bodies;
    flights.books = &world.books;
    flights.walls = world.walls ? &*world.walls : nullptr;
    flights.motion.resize(4 * padded(count));
    set_accelerations(sim);
    sim.candidates.prepare(count);
    sim.candidates.move_places(world.bodies, sim.flight_dt, sim.executor);

    BeginFlight<Real> all = arguments_of(sim);
    const auto kernel = all.radius ? sim.kernels->begin_flight : sim.kernels->begin_flight_uniform_radius;
    const std::size_t rows_per_chunk = drags ? kRowsPerChunk : sim.soft.rows_per_task();
    for (ChunkedList* list : {&sim.wall_rows, &sim.displaced_rows, &sim.lost_rows})
        list->prepare(count, rows_per_chunk);
    sim.chunk_fastest.assign((count + rows_per_chunk - 1) / rows_per_chunk, 0);
    const auto fly = [&](std::size_t chunk, std::size_t first, std::size_t last) {
        BeginFlight<Real> k = all;
        k.wall_rows = sim.wall_rows.part(chunk);
        k.displaced_rows = sim.displaced_rows.part(chunk);
        k.lost_rows = sim.lost_rows.part(chunk);
        const FlightCounts<Real> counts = kernel(k, first, padded(last));
        sim.wall_rows.set_count(chunk, counts.wall);
        sim.displaced_rows.set_count(chunk, counts.displaced);
        sim.lost_rows.set_count(chunk, counts.lost);
        sim.chunk_fastest[chunk] = static_cast<double>(counts.fastest_squared);
    };
    if (drags)
        sim.executor.for_each_chunk(count, rows_per_chunk, fly);
    else
        sim.executor.for_each_chunk(count, rows_per_chunk, kNanosecondsToFly, fly);
    double fastest_squared = 0;
    for (const double fastest : sim.chunk_fastest) fastest_squared = std::fmax(fastest_squared, fastest);
    sim.fastest = std::sqrt(fastest_squared);
    quarantine_lost(sim);
}

template void begin_flight(Simulation<float>&);
template void begin_flight(Simulation<double>&);

}  // namespace carom

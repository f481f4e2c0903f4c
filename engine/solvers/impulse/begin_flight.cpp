#include <utility>

#include "shapes/walls.hpp"
#include "solvers/impulse/stages.hpp"
#include "solvers/shared/pack_motion.hpp"

namespace carom {
namespace {

// With drag * h below kLargestDragTimesStep, a path bulges beyond its ends by at most max|x''| s²/8 <= .7 |a|
// q.
constexpr double kBendOfFall = 0.7;

/// Accelerations a row, where they can differ: gravity and static bodies, or kinematic bodies and drag.
template <class Real>
void set_accelerations(ImpulseSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    Flights<Real>& flights = sim.impulse.flights;
    flights.common_acceleration = world.gravity;
    const bool can_differ = world.effects.gravity || (world.effects.drag && !world.immovable_rows.empty());
    Column<Vec2>& accelerations = sim.impulse.columns.accelerations;
    if (!can_differ || accelerations.size() == world.bodies.count)
        return flights.look_at(sim.impulse.columns);
    accelerations.resize(world.bodies.count);
    for (Vec2& a : accelerations) a = world.gravity;
    for (const std::int32_t row : world.immovable_rows) {
        const auto i = static_cast<std::size_t>(row);
        const Vec2 v{world.bodies.velocity_x[i], world.bodies.velocity_y[i]};
        // x = V t = V s + k V q: steady motion is an acceleration by k V on the clock of things that drag
        // slows.
        accelerations[i] = world.drag.linear * v;
    }
    flights.look_at(sim.impulse.columns);
}

template <class Real>
BeginFlight<Real> arguments_of(ImpulseSimulation<Real>& sim) {
    const WorldState<Real>& world = sim.world;
    const FlightClock& end = sim.impulse.flights.end;
    const auto real = [](double value) { return static_cast<Real>(value); };
    BeginFlight<Real> k = flight_arguments(sim, end);
    k.bend_x = real(std::fabs(world.gravity.x) * end.q * kBendOfFall);
    k.bend_y = real(std::fabs(world.gravity.y) * end.q * kBendOfFall);
    const bool may_rest = length_squared(world.gravity) > 0;
    k.touch_ratio = real(may_rest ? 1 + kTouchFraction : 1);
    const Enclosure<Real> walls(world.walls ? &*world.walls : nullptr);
    k.min_x = walls.min_x, k.min_y = walls.min_y, k.max_x = walls.max_x, k.max_y = walls.max_y;
    k.motion = sim.impulse.flights.motion.data();
    return k;
}

}  // namespace

template <class Real>
void begin_flight(ImpulseSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    Flights<Real>& flights = sim.impulse.flights;
    const std::size_t count = world.bodies.count;
    flights.end = flight_clock_at(sim.flight_dt, world.drag.linear);
    flights.bodies = &world.bodies;
    flights.books = &world.books, flights.interruption = &sim.interruption;
    flights.walls = world.walls ? &*world.walls : nullptr;
    flights.has_friction = world.effects.friction;
    flights.angular_drag = world.effects.friction ? world.drag.angular : 0;
    sim.impulse.columns.motion.resize(4 * padded(count));
    set_accelerations(sim);
    sim.candidates.prepare(count);
    sim.candidates.move_places(world.bodies, sim.flight_dt, sim.executor);

    const BeginFlight<Real> all = arguments_of(sim);
    const auto kernel = all.radius ? sim.kernels->begin_flight : sim.kernels->begin_flight_uniform_radius;
    const std::size_t rows = std::exchange(sim.knows_standing, true) ? world.bodies.moving() : count;
    sim.wall_rows.prepare(rows, kRowsPerChunk);
    pack_motion(
        sim, rows, all, kernel, kRowsPerChunk,
        [&](std::size_t packed, std::size_t per_chunk, const auto& fly) {
            sim.executor.for_each_chunk(packed, per_chunk, fly);
        },
        [&](BeginFlight<Real>& k, std::size_t chunk) { k.wall_rows = sim.wall_rows.part(chunk); },
        [&](const FlightCounts<Real>& counts, std::size_t chunk) {
            sim.wall_rows.set_count(chunk, counts.wall);
        });
    quarantine_lost(sim, sim.impulse.columns.motion);
    set_accelerations(sim);  // those of bodies that were taken out just now
    sim.keep_start_of_substep();
}

template void begin_flight(ImpulseSimulation<float>&);
template void begin_flight(ImpulseSimulation<double>&);

}  // namespace carom

#include "solvers/shared/pack_motion.hpp"
#include "solvers/soft/stages.hpp"

namespace carom {

/// A body, on one thread: for the executor.
constexpr double kNanosecondsToFly = 1;

template <class Real>
void begin_flight(SoftSimulation<Real>& sim) {
    const std::size_t count = sim.world.bodies.count;
    sim.motion.resize(4 * padded(count));
    sim.candidates.prepare(count);
    sim.candidates.move_places(sim.world.bodies, sim.flight_dt, sim.executor);
    // The flight asks only how far bodies may come: drag shortens that.
    BeginFlight<Real> all = flight_arguments(sim, flight_clock_at(sim.flight_dt, 0));
    all.motion = sim.motion.data();
    const auto kernel = all.radius ? sim.kernels->pack_motion : sim.kernels->pack_motion_uniform_radius;
    // The records of standing bodies stay as long as rows, places and masses do.
    const std::size_t rows = sim.soft.knows_rows() ? sim.world.bodies.moving() : count;
    pack_motion(
        sim, rows, all, kernel, sim.soft.rows_per_task(),
        [&](std::size_t packed, std::size_t per_chunk, const auto& fly) {
            sim.executor.for_each_chunk(packed, per_chunk, kNanosecondsToFly, fly);
        },
        [](BeginFlight<Real>&, std::size_t) {}, [](const FlightCounts<Real>&, std::size_t) {});
    quarantine_lost(sim, sim.motion);
}

template void begin_flight(SoftSimulation<float>&);
template void begin_flight(SoftSimulation<double>&);

}  // namespace carom

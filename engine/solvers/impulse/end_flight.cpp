#include "effects/fair_rounding.hpp"
#include "solvers/impulse/stages.hpp"

namespace carom {
namespace {

/// Rows whose flight is not the common one: what the kernel wrote for them is put right.
template <class Real>
void end_special_flights(ImpulseSimulation<Real>& sim) {
    Bodies<Real>& bodies = sim.world.bodies;
    Flights<Real>& flights = sim.impulse.flights;
    const auto real = [](double value) { return static_cast<Real>(value); };
    for (const std::int32_t row : sim.world.immovable_rows_below(padded(bodies.moving()))) {
        const auto i = static_cast<std::size_t>(row);
        const Flight f = flights.flight(row);
        const bool moves = (bodies.flags_of(i) & kKinematic) != 0;
        const Vec2 x = moves ? f.position + flights.end.t * f.velocity : f.position;
        bodies.position_x[i] = real(x.x), bodies.position_y[i] = real(x.y);
        bodies.velocity_x[i] = real(f.velocity.x), bodies.velocity_y[i] = real(f.velocity.y);
    }
    for (const std::int32_t row : sim.impulse.held_rows()) {
        const auto i = static_cast<std::size_t>(row);
        const Flight f = flights.flight(row);
        const Vec2 x = position_at(f, flights.end.s, flights.end.q);
        const Vec2 v = velocity_at(f, flights.end.s, flights.drag());
        bodies.position_x[i] = real(x.x), bodies.position_y[i] = real(x.y);
        bodies.velocity_x[i] = real(v.x), bodies.velocity_y[i] = real(v.y);
        flights.accelerations[i] = flights.common_acceleration;
    }
}

}  // namespace

template <class Real>
void end_flight(ImpulseSimulation<Real>& sim) {
    Bodies<Real>& bodies = sim.world.bodies;
    const FlightClock& end = sim.impulse.flights.end;
    const Vec2 g = sim.world.gravity;
    const auto real = [](double value) { return static_cast<Real>(value); };
    const Real dithered = dither_factor<Real>(++sim.world.falls);
    const EndFlight<Real> k{sim.impulse.flights.motion.data(),
                            real(end.s),
                            real(end.drag * end.s),
                            real(g.x * end.q),
                            real(g.y * end.q),
                            real(g.x * end.s),
                            real(g.y * end.s),
                            bodies.position_x.data(),
                            bodies.position_y.data(),
                            bodies.velocity_x.data(),
                            bodies.velocity_y.data(),
                            g.x != 0 || end.drag != 0 ? dithered : 0,
                            g.y != 0 || end.drag != 0 ? dithered : 0};
    sim.executor.for_each_chunk(bodies.moving(), kRowsPerChunk,
                                [&](std::size_t, std::size_t first, std::size_t last) {
                                    sim.kernels->end_flight(k, first, padded(last));
                                });
    end_special_flights(sim);
    for (Column<Real>* column :
         {&bodies.position_x, &bodies.position_y, &bodies.velocity_x, &bodies.velocity_y})
        for (std::size_t row = bodies.count; row < padded(bodies.count); ++row)
            (*column)[row] = 0;  // it fell too
}

template <class Real>
void advance_rotation(ImpulseSimulation<Real>& sim) {
    Bodies<Real>& bodies = sim.world.bodies;
    const FlightClock clock = flight_clock_at(sim.flight_dt, sim.world.drag.angular);
    sim.immovable_turns.clear();  // drag does not slow what nothing moves
    if (clock.drag != 0)
        for (const std::int32_t row : sim.world.immovable_rows_below(padded(bodies.moving()))) {
            const auto i = static_cast<std::size_t>(row);
            sim.immovable_turns.push_back({bodies.angle[i], bodies.angular_velocity[i]});
        }
    const AdvanceRotation<Real> k{bodies.angle.data(), bodies.angular_velocity.data(),
                                  static_cast<Real>(clock.s), static_cast<Real>(clock.u)};
    sim.executor.for_each_chunk(bodies.moving(), kRowsPerChunk,
                                [&](std::size_t, std::size_t first, std::size_t last) {
                                    sim.kernels->advance_rotation(k, first, padded(last));
                                });
    std::size_t n = 0;
    if (clock.drag == 0) return;
    for (const std::int32_t row : sim.world.immovable_rows_below(padded(bodies.moving()))) {
        const auto i = static_cast<std::size_t>(row);
        const auto [angle, spin] = sim.immovable_turns[n++];
        bodies.angle[i] = static_cast<Real>(angle + clock.t * static_cast<double>(spin));
        bodies.angular_velocity[i] = spin;
    }
}

template void end_flight(ImpulseSimulation<float>&);
template void end_flight(ImpulseSimulation<double>&);
template void advance_rotation(ImpulseSimulation<float>&);
template void advance_rotation(ImpulseSimulation<double>&);

}  // namespace carom

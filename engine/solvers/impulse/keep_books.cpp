#include "solvers/impulse/stages.hpp"

namespace carom {
namespace {

/// Energy and momentum that drag takes from the flights as they end; what was flown before a deflection was
/// booked when it happened (Flights::book_drag).
template <class Real>
void book_linear_drag(ImpulseSimulation<Real>& sim) {
    const Flights<Real>& flights = sim.impulse.flights;
    Books& books = sim.world.books;
    const FlightClock& end = flights.end;
    double energy = 0;
    Vec2 momentum;
    for (std::size_t row = 0; row < sim.world.bodies.moving(); ++row) {
        if (sim.world.bodies.is_immovable(row)) continue;
        const Flight f = flights.flight(static_cast<std::int32_t>(row));
        const double mass = sim.world.bodies.mass[row];
        energy += mass * drag_loss_per_mass(f, end.s, end.q, end.drag);
        momentum += (mass * end.drag) * (position_at(f, end.s, end.q) - f.position);
    }
    books.drag -= energy;
    books.drag_momentum -= momentum;
}

/// Books the work of the contacts that bodies rest on, until the end of their flights.
template <class Real>
void book_supports(ImpulseSimulation<Real>& sim) {
    const Flights<Real>& flights = sim.impulse.flights;
    for (const std::int32_t row : sim.impulse.held_rows())
        sim.world.books.restitution +=
            flights.support_work(row, flights.flight(row), flights.end.s, flights.end.q);
}

template <class Real>
void book_angular_drag(ImpulseSimulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    const double u = flight_clock_at(sim.flight_dt, sim.world.drag.angular).u;
    for (std::size_t row = 0; row < bodies.moving(); ++row)
        sim.world.books.drag -= (1 - u * u) * sim.world.sums_of(row).energy.rotational;
}

}  // namespace

template <class Real>
void keep_books(ImpulseSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    world.books.gravity_momentum += (world.dynamic_mass * sim.flight_dt) * world.gravity;
    book_supports(sim);
    if (sim.impulse.flights.drag() != 0) book_linear_drag(sim);
    if (world.bodies.has_rotation && world.drag.angular != 0) book_angular_drag(sim);
}

template void keep_books(ImpulseSimulation<float>&);
template void keep_books(ImpulseSimulation<double>&);

}  // namespace carom

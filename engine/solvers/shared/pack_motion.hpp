#pragma once

#include <carom/scene.hpp>

#include <cmath>

#include "solvers/shared/simulation.hpp"

namespace carom {

/// Arguments of the kernel begin_flight, but for the walls and the motion it writes.
/// @param end  the clock of the flight at its end
template <class Real>
BeginFlight<Real> flight_arguments(const Simulation<Real>& sim, const FlightClock& end) {
    const WorldState<Real>& world = sim.world;
    const Bodies<Real>& bodies = world.bodies;
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
    k.largest_position = real(kLargestPosition), k.largest_speed = real(kLargestSpeed);
    return k;
}

/// Runs a begin_flight kernel over rows from the first on: packs their motion, lists those that leave their
/// margins or the limits, and finds the largest speed.
/// @param rows  how many
/// @param loop  calls its last argument for chunks of rows: Executor::for_each_chunk
/// @param finish  finish(k, chunk) completes the arguments of a chunk
/// @param done  done(counts, chunk) takes what else the kernel has listed
template <class Real, class Kernel, class Loop, class Finish, class Done>
void pack_motion(Simulation<Real>& sim, std::size_t rows, const BeginFlight<Real>& all, Kernel kernel,
                 std::size_t rows_per_chunk, const Loop& loop, const Finish& finish, const Done& done) {
    for (ChunkedList* list : {&sim.displaced_rows, &sim.lost_rows}) list->prepare(rows, rows_per_chunk);
    sim.chunk_fastest.assign((rows + rows_per_chunk - 1) / rows_per_chunk, 0);
    loop(rows, rows_per_chunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
        BeginFlight<Real> k = all;
        k.displaced_rows = sim.displaced_rows.part(chunk), k.lost_rows = sim.lost_rows.part(chunk);
        finish(k, chunk);
        const FlightCounts<Real> counts = kernel(k, first, padded(last));
        sim.displaced_rows.set_count(chunk, counts.displaced), sim.lost_rows.set_count(chunk, counts.lost);
        sim.chunk_fastest[chunk] = static_cast<double>(counts.fastest_squared);
        done(counts, chunk);
    });
    double fastest_squared = 0;
    for (const double fastest : sim.chunk_fastest) fastest_squared = std::fmax(fastest_squared, fastest);
    sim.fastest = std::sqrt(fastest_squared);
}

/// Takes bodies out whose next state would be no number or beyond the limits, where they are.
/// @param motion  their records, in which they stop
template <class Real>
void quarantine_lost(Simulation<Real>& sim, Column<Real>& motion) {
    bool any = false;
    sim.lost_rows.for_each_below(sim.world.bodies.count, [&](std::int32_t number) {
        const auto row = static_cast<std::size_t>(number);
        if (sim.world.bodies.is_immovable(row) && (sim.world.bodies.flags_of(row) & kKinematic) == 0)
            return;  // static bodies do not fall, though the kernel thinks so
        sim.world.quarantine(row);
        motion[4 * row + 2] = 0, motion[4 * row + 3] = 0;
        any = true;
    });
    if (any) sim.forget_derived_state();
}

}  // namespace carom

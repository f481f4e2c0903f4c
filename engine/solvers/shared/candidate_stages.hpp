#pragma once

#include "solvers/shared/simulation.hpp"

namespace carom {

/// Sorts the rows that are awake by place in the plane, if they have drifted far from that order.
/// @param rows_move  called with the order, new row i is the old row order[i], before they do
template <class Real, class RowsMove>
void sort_rows_by_place(Simulation<Real>& sim, const RowsMove& rows_move) {
    if (!sim.candidates.wants_sorted_rows()) return;
    rows_move(sim.candidates.order());
    sim.world.reorder(sim.candidates.order());
    sim.candidates.note_sorted_rows();
}

/// Builds the candidate pairs anew if bodies leave the margins of the old ones.
/// @param end  the clock of the flight at its end
template <class Real>
void find_candidate_pairs(Simulation<Real>& sim, const FlightClock& end) {
    const Bodies<Real>& bodies = sim.world.bodies;
    sim.displaced.clear();
    sim.displaced_rows.for_each_below(bodies.count, [&](std::int32_t row) {
        if ((bodies.flags_of(static_cast<std::size_t>(row)) & (kEdges | kSensor)) == 0)
            sim.displaced.push_back(row);
    });
    sim.candidates.update(bodies, end, sim.world.gravity, sim.displaced, sim.fastest, *sim.kernels,
                          sim.executor);
}

}  // namespace carom

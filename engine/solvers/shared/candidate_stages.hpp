#pragma once

#include <algorithm>
#include <utility>

#include "solvers/shared/simulation.hpp"

namespace carom {

/// Static bodies get rows of their own, which steps pass over, if there are so many of them and no fewer than
/// others (docs/decisions/0033-costs-of-strangers.md).
inline constexpr std::size_t kFewestStanding = 1024;

/// Whether static bodies among the rows that steps look at are to leave these.
/// Cost: O(log bodies), and O(bodies) when immovable bodies have come or gone.
template <class Real>
bool wants_standing_rows(Simulation<Real>& sim) {
    const WorldState<Real>& world = sim.world;
    const std::size_t immovable = world.immovable_rows.size() - world.bodies.standing,
                      fewest = std::max(kFewestStanding, world.bodies.moving() - immovable);
    if (immovable < fewest || !sim.candidates.is_valid()) return false;
    if (std::exchange(sim.immovable_when_asked, world.immovable_rows.size()) == world.immovable_rows.size())
        return false;
    const auto stands = [&](std::int32_t row) { return world.bodies.stands(static_cast<std::size_t>(row)); };
    const auto rows = world.immovable_rows_below(world.bodies.moving());
    return static_cast<std::size_t>(std::count_if(rows.begin(), rows.end(), stands)) >= fewest;
}

/// Sorts the rows that are awake by place in the plane, if they have drifted far from that order, and those
/// of standing bodies to their end, if that pays.
/// @param rows_move  called with the order, new row i is the old row order[i], before they do
template <class Real, class RowsMove>
void sort_rows_by_place(Simulation<Real>& sim, const RowsMove& rows_move) {
    Bodies<Real>& bodies = sim.world.bodies;
    const bool parts = wants_standing_rows(sim) || bodies.standing > 0;
    if (!sim.candidates.wants_sorted_rows(bodies.moving()) && !(parts && bodies.standing == 0)) return;
    sim.candidates.prepare_order(bodies.count);
    const std::int32_t* order = sim.candidates.order();
    std::size_t standing = 0;
    if (parts) {
        sim.row_order.assign(order, order + bodies.count);
        const auto first = std::stable_partition(
            sim.row_order.begin(), sim.row_order.end(),
            [&](std::int32_t row) { return !bodies.stands(static_cast<std::size_t>(row)); });
        order = sim.row_order.data();
        standing = static_cast<std::size_t>(sim.row_order.end() - first);
    }
    rows_move(order);
    sim.world.reorder(order);
    bodies.standing = standing;
    sim.candidates.note_sorted_rows();
}

/// Builds the candidate pairs anew if bodies leave the margins of the old ones.
/// @param end  the clock of the flight at its end
template <class Real>
void find_candidate_pairs(Simulation<Real>& sim, const FlightClock& end) {
    const Bodies<Real>& bodies = sim.world.bodies;
    sim.displaced.clear();
    sim.displaced_rows.for_each_below(bodies.moving(), [&](std::int32_t row) {
        if ((bodies.flags_of(static_cast<std::size_t>(row)) & (kEdges | kSensor)) == 0)
            sim.displaced.push_back(row);
    });
    sim.candidates.update(bodies, end, sim.world.gravity, sim.displaced, sim.fastest, *sim.kernels,
                          sim.executor, &sim.world.shapes);
}

}  // namespace carom

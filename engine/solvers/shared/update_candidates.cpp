#include "solvers/shared/stages.hpp"

namespace carom {

template <class Real>
void sort_rows(Simulation<Real>& sim) {
    if (!sim.candidates.wants_sorted_rows()) return;
    if (sim.solver == Solver::soft) {
        sim.soft.graph.trail.follow_sorted(sim.candidates.order(), sim.world.bodies.count);
        sim.soft.forget_rows();
    }
    sim.world.reorder(sim.candidates.order());
    sim.candidates.note_sorted_rows();
    sim.impulse.flights.accelerations.clear();
}

template <class Real>
void update_candidates(Simulation<Real>& sim) {
    const Bodies<Real>& bodies = sim.world.bodies;
    sim.displaced.clear();
    sim.displaced_rows.for_each_below(bodies.count, [&](std::int32_t row) {
        if ((bodies.flags_of(static_cast<std::size_t>(row)) & kEdges) == 0) sim.displaced.push_back(row);
    });
    if (sim.solver == Solver::soft) {
        sim.edge_candidates.place(sim.world, sim.flight_dt);
        if (sim.edge_candidates.has_left_margin()) sim.candidates.invalidate_pairs();
    }
    sim.candidates.update(bodies, sim.impulse.flights.end, sim.world.gravity, sim.displaced, sim.fastest,
                          *sim.kernels, sim.executor);
}

template void sort_rows(Simulation<float>&);
template void sort_rows(Simulation<double>&);
template void update_candidates(Simulation<float>&);
template void update_candidates(Simulation<double>&);

}  // namespace carom

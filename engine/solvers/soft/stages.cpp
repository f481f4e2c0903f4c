#include "solvers/shared/stages.hpp"

namespace carom {

template <class Real>
void begin_substeps(Simulation<Real>& sim) {
    sim.soft.begin_substeps(sim.world, sim.impulse.flights.motion, sim.substep_dt, sim.world.gravity,
                            *sim.kernels, sim.executor);
}

template <class Real>
void update_contacts(Simulation<Real>& sim) {
    sim.soft.graph.keeps_rolling = sim.world.effects.rolling_resistance;
    const Walls* walls = sim.world.walls ? &*sim.world.walls : nullptr;
    sim.soft.graph.sleepers = sim.sleepers.pairs();
    if (sim.graph_of_rebuild != sim.candidates.rebuild_count() && sim.world.effects.sleeping)
        Sleepers<Real>::forget_contacts(sim.soft.graph, sim.world);
    const bool has_edges = !sim.world.edges.empty();
    if (sim.graph_of_rebuild == sim.candidates.rebuild_count()) {
        if (has_edges) sim.edge_candidates.add_strays(sim.world, sim.candidates);
        sim.soft.graph.add(sim.candidates, sim.edge_candidates, sim.world.bodies, walls);
    } else {
        if (has_edges) sim.edge_candidates.find(sim.world, sim.candidates);
        sim.soft.graph.renew(sim.candidates, sim.edge_candidates, sim.world.bodies, walls, sim.executor);
    }
    sim.graph_of_rebuild = sim.candidates.rebuild_count();
    sim.sleepers.restore_impulses(sim.soft.graph, sim.world, sim.soft.substep_of_impulses());
}

template <class Real>
void find_contacts(Simulation<Real>& sim) {
    const std::size_t padding_rows = ContactGraph<Real>::padding_rows(sim.soft.graph.groups);
    sim.impulse.flights.motion.resize(4 * padded(sim.world.bodies.count + padding_rows));
    sim.soft.find_contacts(sim.world, sim.candidates, sim.edge_candidates, sim.impulse.flights.motion,
                           sim.flight_dt);
}

template <class Real>
void solve_contacts(Simulation<Real>& sim) {
    sim.soft.solve_contacts(sim.substep, sim.substep + 1 == sim.substep_count, sim.impulse.flights.motion);
}

template <class Real>
void book_substep(Simulation<Real>& sim) {
    sim.soft.book_substep(sim.world, sim.world.books);
}

template <class Real>
void book_displacements(Simulation<Real>& sim) {
    sim.soft.book_displacements(sim.world, sim.impulse.flights.motion, sim.world.books);
}

template <class Real>
void advance_bodies(Simulation<Real>& sim) {
    sim.soft.advance_bodies(sim.substep + 1 == sim.substep_count);
}

template <class Real>
void end_contacts(Simulation<Real>& sim) {
    sim.soft.end_contacts(sim.world, sim.world.books);
    sim.soft.project_positions(sim.world, sim.edge_candidates, sim.impulse.flights.motion, sim.candidates,
                               sim.fastest);
}

template <class Real>
void end_substeps(Simulation<Real>& sim) {
    sim.soft.end_substeps(sim.world.bodies, sim.lost);
    if (!sim.world.edges.empty())
        sim.soft.undo_tunnelling(sim.world, sim.edge_candidates, sim.impulse.flights.motion, sim.candidates,
                                 sim.fastest);
    if (sim.world.walls) clamp_to_walls(sim);
    if (sim.lost.empty()) return;
    for (const std::int32_t row : sim.lost)
        if (!sim.world.bodies.is_immovable(static_cast<std::size_t>(row)))
            sim.world.quarantine(static_cast<std::size_t>(row));
    sim.forget_derived_state();
}

template void begin_substeps(Simulation<float>&);
template void begin_substeps(Simulation<double>&);
template void update_contacts(Simulation<float>&);
template void update_contacts(Simulation<double>&);
template void find_contacts(Simulation<float>&);
template void find_contacts(Simulation<double>&);
template void solve_contacts(Simulation<float>&);
template void solve_contacts(Simulation<double>&);
template void advance_bodies(Simulation<float>&);
template void advance_bodies(Simulation<double>&);
template void book_substep(Simulation<float>&);
template void book_substep(Simulation<double>&);
template void book_displacements(Simulation<float>&);
template void book_displacements(Simulation<double>&);
template void end_contacts(Simulation<float>&);
template void end_contacts(Simulation<double>&);
template void end_substeps(Simulation<float>&);
template void end_substeps(Simulation<double>&);

}  // namespace carom

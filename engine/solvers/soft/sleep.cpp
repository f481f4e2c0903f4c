#include "solvers/soft/stages.hpp"

namespace carom {
namespace {

/// Rows have changed places: what was derived from them is made anew.
template <class Real>
void rows_changed(SoftSimulation<Real>& sim) {
    sim.world.list_immovable_rows();
    sim.forget_derived_state();
}

/// While segments or chains move no body sleeps: they may be anywhere.
template <class Real>
bool do_edges_move(const WorldState<Real>& world) {
    const Bodies<Real>& bodies = world.bodies;
    for (const std::int32_t row : world.immovable_rows_below(bodies.moving())) {
        const auto i = static_cast<std::size_t>(row);
        if ((bodies.flags_of(i) & kEdges) == 0) continue;
        if (bodies.velocity_x[i] != 0 || bodies.velocity_y[i] != 0) return true;
        if (bodies.has_rotation && bodies.angular_velocity[i] != 0) return true;
    }
    return false;
}

}  // namespace

template <class Real>
bool wake_marked(SoftSimulation<Real>& sim) {
    Sleepers<Real>::forget_contacts(sim.soft.graph);
    if (sim.sleepers.wake_marked(sim.world) == 0) return false;
    rows_changed(sim);
    return true;
}

template <class Real>
void wake_sleepers(SoftSimulation<Real>& sim) {
    if (sim.world.bodies.asleep == 0) return;
    if (do_edges_move(sim.world)) {
        sim.sleepers.mark_all(sim.world);
        wake_marked(sim);
        begin_flight(sim);
        update_candidates(sim);
        return;
    }
    const auto find_pairs = [&] {
        sim.sleepers.find_pairs(sim.world, sim.candidates, *sim.kernels, sim.executor);
    };
    if (!sim.candidates.strays().empty() &&
        sim.sleepers.is_near_any(sim.world, sim.candidates, sim.candidates.strays())) {
        sim.candidates.invalidate_pairs();
        update_candidates(sim);
    }
    find_pairs();
    if (!sim.sleepers.mark_hit(sim.world, sim.flight_dt, sim.substep_dt)) return;
    wake_marked(sim);
    begin_flight(sim);
    update_candidates(sim);
    find_pairs();
}

template <class Real>
void put_to_sleep(SoftSimulation<Real>& sim) {
    WorldState<Real>& world = sim.world;
    const std::span<const LoadedContact> others = sim.soft.paths.manifolds.loaded();
    bool is_pressed = sim.sleepers.mark_pressed(world, sim.soft.graph, others, sim.substep_dt);
    if (!sim.lost.empty()) is_pressed = sim.sleepers.mark_all(world);  // what they lay on may be gone
    if (is_pressed) {
        wake_marked(sim);
        return;
    }
    if (do_edges_move(world)) return;
    if (!sim.sleepers.put_to_sleep(world, sim.soft.graph, others, sim.flight_dt, sim.substep_dt)) return;
    Sleepers<Real>::forget_contacts(sim.soft.graph);
    rows_changed(sim);
}

template void wake_sleepers(SoftSimulation<float>&);
template void wake_sleepers(SoftSimulation<double>&);
template void put_to_sleep(SoftSimulation<float>&);
template void put_to_sleep(SoftSimulation<double>&);
template bool wake_marked(SoftSimulation<float>&);
template bool wake_marked(SoftSimulation<double>&);

}  // namespace carom

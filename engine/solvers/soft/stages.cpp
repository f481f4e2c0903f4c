#include "solvers/soft/stages.hpp"

#include <algorithm>
#include <cassert>

#include "constraints/contact_faults.hpp"
#include "solvers/shared/candidate_stages.hpp"
#include "state/edge_tracks.hpp"

namespace carom {

template <class Real>
void sort_rows(SoftSimulation<Real>& sim) {
    sort_rows_by_place(sim, [&](const std::int32_t* order) {
        sim.soft.graph.trail.follow_sorted(order, sim.world.bodies.count);
        sim.soft.forget_rows(), sim.soft.paths.turns.forget(), sim.edge_candidates.forget_rows();
    });
}

/// Where edges that move reach more than one body in this many, all pairs are found anew with theirs.
constexpr std::size_t kBodiesPerMovedPair = 64;

template <class Real>
bool moves_few_contacts(const SoftSimulation<Real>& sim) {
    const WorldState<Real>& world = sim.world;
    const std::span<const EdgePair> pairs = sim.edge_candidates.pairs();
    const auto moves = [&](const EdgePair& pair) {
        const std::size_t row = world.handles.row_of_slot(world.edges.body_of(pair.edge).id.index);
        return world.bodies.velocity_x[row] != 0 || world.bodies.velocity_y[row] != 0 ||
               (world.bodies.has_rotation && world.bodies.angular_velocity[row] != 0);
    };
    const auto moved = static_cast<std::size_t>(std::count_if(pairs.begin(), pairs.end(), moves));
    return moved * kBodiesPerMovedPair <= world.bodies.moving();
}

template <class Real>
void update_candidates(SoftSimulation<Real>& sim) {
    if (join_segments(sim.world)) sim.candidates.invalidate_pairs();
    sim.edge_candidates.place(sim.world, sim.flight_dt);
    // Void pairs may be of edges that are gone.
    if (sim.candidates.is_valid() && sim.edge_candidates.has_left_margin(sim.world) &&
        (sim.world.bodies.has_shapes || sim.world.bodies.asleep > 0 || !sim.edge_candidates.may_add() ||
         !moves_few_contacts(sim)))
        sim.candidates.invalidate_pairs();
    const std::int64_t former = sim.candidates.rebuild_count();
    find_candidate_pairs(sim, flight_clock_at(sim.flight_dt, 0));
    while (sim.candidates.rebuild_count() != former && sim.shorten_flight()) {
        begin_flight(sim);
        sim.edge_candidates.place(sim.world, sim.flight_dt);
        find_candidate_pairs(sim, flight_clock_at(sim.flight_dt, 0));
    }
}

template <class Real>
void update_contacts(SoftSimulation<Real>& sim) {
    sim.soft.graph.keeps_rolling = sim.world.effects.rolling_resistance;
    sim.soft.graph.filter = sim.world.has_filters() ? &sim.world : nullptr;
    const Walls* walls = sim.world.walls ? &*sim.world.walls : nullptr;
    sim.soft.graph.sleepers = sim.sleepers.pairs();
    if (sim.graph_of_rebuild != sim.candidates.rebuild_count() && sim.world.effects.sleeping)
        Sleepers<Real>::forget_contacts(sim.soft.graph);
    if (sim.graph_of_rebuild == sim.candidates.rebuild_count()) {
        sim.edge_candidates.add_strays(sim.world, sim.candidates);
        sim.soft.graph.add(sim.candidates, sim.edge_candidates, sim.world.bodies, walls);
        sim.soft.paths.manifolds.add(sim.world, sim.candidates, sim.edge_candidates);
    } else {
        sim.edge_candidates.find(sim.world, sim.candidates);
        sim.soft.graph.renew(sim.candidates, sim.edge_candidates, sim.world.bodies, walls, sim.executor);
        sim.soft.paths.manifolds.renew(sim.world, sim.candidates, sim.edge_candidates, sim.sleepers.pairs(),
                                       sim.executor);
        sim.kinds_of_graph = sim.kinds_of_columns();
    }
    sim.graph_of_rebuild = sim.candidates.rebuild_count();
    sim.sleepers.restore_impulses(sim.soft.graph, sim.world, sim.soft.substep_of_impulses());
    assert(!fault_of(sim.soft.graph.pairs, sim.soft.graph.groups, sim.world.bodies, true));
    assert(!fault_of(sim.soft.graph.supports, sim.soft.graph.groups, sim.world.bodies, false));
}

template <class Real>
void end_joints(SoftSimulation<Real>& sim) {
    if (sim.soft.end_joints(sim.world, sim.world.books, sim.flights)) sim.forget_derived_state();
}

template <class Real>
void undo_tunnelling(SoftSimulation<Real>& sim) {
    sim.edge_candidates.settle(sim.world);
    if (!sim.world.edges.empty())
        sim.tunnelling.undo(sim.world, sim.flight(), sim.soft.graph.supports, sim.executor);
    if (sim.world.bodies.has_shapes && sim.can_touch())
        sim.shape_tunnelling.undo(sim.world, sim.flight(), sim.soft.records(), sim.soft.paths.manifolds,
                                  sim.executor);
}

template <class Real>
void quarantine_bodies(SoftSimulation<Real>& sim) {
    for (const std::int32_t lost : sim.lost) {
        const auto row = static_cast<std::size_t>(lost);
        if (!sim.world.bodies.is_immovable(row))
            sim.world.quarantine(row, sim.soft.records().sums_of_lost(sim.world, row));
    }
    // What a joint did to a body that was lost may be no number.
    JointStore& joints = sim.world.joints;
    const auto is_lost = [&](BodyId id) {
        return id != BodyId{} &&
               (sim.world.bodies.flags_of(sim.world.handles.row_of_slot(id.index)) & kDisabled) != 0;
    };
    joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
        if (is_lost(joint.a) || is_lost(joint.b)) joints[slot].force = {}, joints[slot].torque = 0;
    });
    sim.forget_derived_state();
}

template void sort_rows(SoftSimulation<float>&);
template void sort_rows(SoftSimulation<double>&);
template void update_candidates(SoftSimulation<float>&);
template void update_candidates(SoftSimulation<double>&);
template void update_contacts(SoftSimulation<float>&);
template void update_contacts(SoftSimulation<double>&);
template void end_joints(SoftSimulation<float>&);
template void end_joints(SoftSimulation<double>&);
template void undo_tunnelling(SoftSimulation<float>&);
template void undo_tunnelling(SoftSimulation<double>&);
template void quarantine_bodies(SoftSimulation<float>&);
template void quarantine_bodies(SoftSimulation<double>&);

}  // namespace carom

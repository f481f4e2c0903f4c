#include "world/set_up.hpp"

#include <optional>

#include "constraints/joints/gear_joint.hpp"
#include "isa/select_isa.hpp"
#include "scene/choose_solver.hpp"
#include "scene/validation/validation.hpp"

namespace carom {

Accuracy accuracy_of(const Scene& scene, const WorldOptions& options) {
    Accuracy accuracy = scene.accuracy;
    if (options.substeps) accuracy.substeps = options.substeps;
    if (options.iterations) accuracy.iterations = options.iterations;
    if (options.solver) accuracy.solver = *options.solver;
    accuracy.solver = choose_solver(scene, accuracy).solver;
    return accuracy;
}

template <class Real>
void set_up(Simulation<Real>& sim, const Scene& scene, const WorldOptions& options, const Effects& effects) {
    const Accuracy accuracy = accuracy_of(scene, options);
    sim.kernels = &select_kernels(options.isa).template of<Real>();
    sim.executor = Executor(options.threads, options.parallel_for);
    sim.substeps_asked_for = accuracy.substeps.value_or(default_substeps(sim.solver()));
    sim.has_asked_for_substeps = accuracy.substeps.has_value();
    sim.set_iterations(accuracy.iterations);
    WorldState<Real>& world = sim.world;
    world.effects = effects;
    world.gravity = scene.gravity;
    world.drag = {effects.drag ? scene.drag.linear : 0, effects.rotation ? scene.drag.angular : 0};
    world.walls = scene.walls;
    world.books.is_open = effects.ledger;
#ifndef NDEBUG
    world.books.is_open = true;  // debug builds check energies in every step
#endif
    world.bodies.has_rotation = effects.rotation;
    world.bodies.has_sleep = effects.sleeping;
    world.sensing.is_on = scene.events.sensor.value_or(true);
    world.sensing.keeps = options.keep_events;
    for (const Body& body : scene.bodies) world.append(body);
    for (const Joint& joint : scene.joints) world.joints.add(joint_of(world, joint));
    world.initial = world.sums();
    world.energy_watch.energy = world.initial.energy.total();
}

template <class Real>
StoredJoint joint_of(const WorldState<Real>& world, const Joint& joint) {
    const auto state_of = [&](const std::optional<BodyId>& id) -> JointBody {
        if (!id) return {};
        const std::size_t row = world.handles.row_of_slot(id->index);
        const Bodies<Real>& b = world.bodies;
        return {{b.position_x[row], b.position_y[row]},
                b.has_rotation ? static_cast<double>(b.angle[row]) : 0};
    };
    StoredJoint stored = stored_joint(joint, state_of(joint.a), state_of(joint.b));
    if (stored.first == kNoJoint) return stored;
    const auto mover_of = [&](std::uint32_t slot) {
        const StoredJoint& of = world.joints[slot];
        const bool is_held = world.bodies.is_immovable(world.handles.row_of_slot(of.b.index));
        return is_held ? of.a : of.b;
    };
    stored.a = mover_of(stored.first), stored.b = mover_of(stored.second);
    stored.angle = 0;
    stored.angle = gear_value(world.joints, stored, [&](BodyId id) -> JointPose {
        if (id == BodyId{}) return {};
        const JointBody body = state_of(id);
        return {body.position, rotation_by(body.angle), body.angle};
    });
    return stored;
}

template StoredJoint joint_of(const WorldState<float>&, const Joint&);
template StoredJoint joint_of(const WorldState<double>&, const Joint&);
template void set_up(Simulation<float>&, const Scene&, const WorldOptions&, const Effects&);
template void set_up(Simulation<double>&, const Scene&, const WorldOptions&, const Effects&);

}  // namespace carom

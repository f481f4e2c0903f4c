#pragma once

#include <carom/world.hpp>

#include <memory>
#include <string>

#include "scene/choose_solver.hpp"
#include "scene/validation/validation.hpp"
#include "shapes/mass.hpp"
#include "shapes/materials.hpp"
#include "step/make_simulation.hpp"
#include "world/report.hpp"
#include "world/snapshot.hpp"

namespace carom {

/// What is behind a world: its simulation, and what it was asked for.
template <class Real>
struct BasicWorld<Real>::Implementation : WorldSettings {
    std::unique_ptr<Simulation<Real>> simulation;
    int threads = 0;
    ParallelFor parallel_for;
    Profile of_earlier_solvers;  // what they counted

    Simulation<Real>& sim() { return *simulation; }
    const Simulation<Real>& sim() const { return *simulation; }
    WorldState<Real>& world() { return simulation->world; }
    Bodies<Real>& bodies() { return simulation->world.bodies; }
    std::size_t row_of(BodyId body, std::string_view where) const {
        return simulation->world.handles.row_of(body, where);
    }

    /// A simulation of another solver in place of the present one, without its state.
    std::unique_ptr<Simulation<Real>> make_next(Solver solver) {
        std::unique_ptr<Simulation<Real>> next = make_simulation<Real>(solver);
        next->kernels = sim().kernels, next->executor = std::move(sim().executor);
        next->interruption.set_question(sim().interruption.question());
        return next;
    }

    void turn_rotation_on() {
        Bodies<Real>& b = bodies();
        if (b.has_rotation) return;
        b.has_rotation = true;
        b.angle.resize(b.rows()), b.angular_velocity.resize(b.rows());
        world().effects.rotation = true;
        report_on("rotation", "a body turns");
        if (!(angular_drag > 0)) return;
        world().drag.angular = angular_drag;
        world().effects.angular_drag = true;
        report_on("angular drag", "a body turns");
    }

    void report_on(std::string_view effect, const char* reason) {
        for (EffectReport& report : called.reports)
            if (report.name == effect) report.on = true, report.reason = reason;
    }

    /// The bodies as a scene, as far as solvers ask.
    Scene as_scene() const {
        const WorldState<Real>& state = simulation->world;
        const Bodies<Real>& b = state.bodies;
        Scene scene;
        scene.gravity = state.gravity, scene.drag = state.drag, scene.walls = state.walls;
        scene.effects = overrides;
        if (state.effects.sleeping) scene.effects.sleep = true;
        for (std::size_t row = 0; row < b.rows(); ++row) {
            Body body;
            if (!b.is_disc(row)) body.shape = state.shape_of(row);
            if (b.is_immovable(row)) body.type = BodyType::static_body;
            if (b.has_groups) body.group = b.group[row];
            body.sensor = (b.flags_of(row) & kSensor) != 0;
            body.category = b.category(row), body.mask = b.mask(row);
            body.material = {.friction = b.friction[row],
                             .restitution = b.restitution[row],
                             .rolling_resistance = b.rolling_resistance[row]};
            scene.bodies.push_back(std::move(body));
        }
        scene.joints.resize(state.joints.count());
        return scene;
    }

    /// Goes on with another solver: the state stays, what was derived from it is made anew.
    void change_solver(Solver solver, const std::string& reason) {
        Simulation<Real>& old = sim();
        called.solver_reason = reason;
        if (solver == old.solver()) return;
        old.wake_all();  // the others know no sleep
        add_counts(old, of_earlier_solvers);
        std::unique_ptr<Simulation<Real>> next = make_next(solver);
        next->step_count = old.step_count;
        next->substeps_asked_for = substeps.value_or(default_substeps(solver));
        next->has_asked_for_substeps = substeps.has_value();
        next->set_iterations(iterations);
        next->world = std::move(old.world);
        simulation = std::move(next);
    }

    /// Turns on what a body to be added calls for and no other body has.
    void call_effects_of(const Body& body, Solver solver) {
        Effects& on = world().effects;
        const bool bounces = has_restitution(body) && !on.restitution;
        const bool resists = has_rolling_resistance(body) && !on.rolling_resistance;
        const bool rubs = (has_friction(body) || resists) && !on.friction;
        if (!bounces && !resists && !rubs) return;
        Scene alone;  // what is forced off cannot be called for
        alone.accuracy.solver = solver;
        alone.add(body);
        validate_effects(alone, overrides, "World::add");
        const auto turn_on = [&](bool is_called, bool& effect, std::string_view name, const char* reason) {
            if (!is_called) return;
            effect = true;
            report_on(name, reason);
        };
        turn_on(bounces, on.restitution, "restitution", "a body that was added has a restitution above zero");
        turn_on(rubs, on.friction, "friction", "a body that was added has friction");
        turn_on(resists, on.rolling_resistance, "rolling resistance",
                "a body that was added has rolling resistance");
        if (rubs) turn_rotation_on();
    }

    /// Calls change(), which alters one body from outside, and keeps the books right.
    template <class Change>
    void change_row(std::size_t row, const Change& change) {
        const Sums before = world().sums_of(row);
        change();
        world().bring(world().sums_of(row) - before);
    }

    Mobility mobility_of(std::size_t row) const {
        const std::uint8_t flags = simulation->world.bodies.flags_of(row);
        if (flags & kDisabled) return Mobility::quarantined;
        if (flags & kKinematic) return Mobility::all;
        if (flags & kImmovable) return Mobility::none;
        return flags & kFixedAngle ? Mobility::no_rotation : Mobility::all;
    }

    /// Wakes a body that is about to be changed, and those that touch it. @return its row then
    std::size_t wake_around(std::size_t row) {
        const Bodies<Real>& b = bodies();
        if (b.asleep == 0) return row;
        const BodyId id = b.id[row];
        if (b.flags_of(row) & kEdges) sim().wake_all();
        sim().wake_body(row);
        const std::size_t now = world().handles.row_of_slot(id.index);
        sim().wake_at({b.position_x[now], b.position_y[now]}, b.radius[now]);
        return world().handles.row_of_slot(id.index);
    }

    /// Wakes the bodies of a joint that is about to change.
    void wake_joint(std::size_t slot) {
        const StoredJoint joint = world().joints[slot];
        for (const BodyId id : {joint.a, joint.b})
            if (id != BodyId{}) wake_around(world().handles.row_of_slot(id.index));
    }

    /// What a body that is added turns on.
    struct Called {
        CalledEffects called;
        SolverFacts facts;
        Effects effects;
        Drag drag;
        bool has_rotation = false;
    };
    Called what_is_called() const {
        const WorldState<Real>& state = simulation->world;
        return {called, facts, state.effects, state.drag, state.bodies.has_rotation};
    }
    void call_again(Called before) {
        called = std::move(before.called), facts = std::move(before.facts);
        world().effects = before.effects, world().drag = before.drag;
        Bodies<Real>& b = bodies();
        if (before.has_rotation || !b.has_rotation) return;
        b.has_rotation = false;
        b.angle.resize(0), b.angular_velocity.resize(0);
    }

    /// A solver may refuse what the bodies are now: then undo() takes the change back.
    template <class Undo>
    void undo_if_refused(std::string_view where, const Undo& undo) {
        try {
            sim().check_bodies(where);
        } catch (const Error&) {
            undo();
            sim().forget_derived_state();
            throw;
        }
    }

    std::vector<BodyId> quarantined() const {
        std::vector<BodyId> ids;
        const WorldState<Real>& state = simulation->world;
        for (std::size_t slot = 0; slot < state.handles.slot_count(); ++slot) {
            const std::uint32_t row = state.handles.row_of_slot(slot);
            if (row != Handles::kNoRow && (state.bodies.flags_of(row) & kDisabled))
                ids.push_back(state.bodies.id[row]);
        }
        return ids;
    }
};

}  // namespace carom

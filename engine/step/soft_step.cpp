
#include "solvers/joints/built_in_pairs.hpp"
#include "solvers/shared/check_energy.hpp"
#include "solvers/soft/stages.hpp"
#include "stages/stage.hpp"
#include "step/make_simulation.hpp"

// THE STEP of solver `soft`: contacts are found once a flight, then solved in substeps.
// docs/how-a-step-works.md has a paragraph on each line.

namespace carom {
namespace {

template <class Real>
class SoftStep final : public SoftSimulation<Real> {
    using Sim = SoftSimulation<Real>;

    static constexpr auto always = [](const Sim&) { return true; };
    static constexpr auto can_meet = [](const Sim& sim) { return sim.can_touch(); };
    static constexpr auto sleeps = [](const Sim& sim) {
        return sim.world.effects.sleeping && sim.can_touch();
    };
    static constexpr auto bounces = [](const Sim& sim) {
        return sim.world.effects.restitution && sim.can_touch();
    };
    static constexpr auto has_shapes = [](const Sim& sim) {
        return sim.world.bodies.has_shapes && !sim.soft.joints.is_rattle;
    };
    static constexpr auto has_edges_or_shapes = [](const Sim& sim) {
        return (!sim.world.edges.empty() || has_shapes(sim)) && sim.can_meet();
    };
    static constexpr auto has_changes = [](const Sim& sim) { return sim.has_changes(); };
    static constexpr auto has_walls = [](const Sim& sim) { return sim.world.effects.walls; };
    static constexpr auto has_discs_alone = [](const Sim& sim) {
        return !sim.world.bodies.has_shapes && sim.world.joints.empty();
    };
    static constexpr auto has_ledger = [](const Sim& sim) { return sim.world.books.is_open; };
    static constexpr auto has_books = [](const Sim& sim) {
        return sim.world.books.is_open || sim.world.effects.walls;
    };
    static constexpr auto has_lost_loads = [](const Sim& sim) { return sim.soft.has_lost_loads(); };
    static constexpr auto may_heave = [](const Sim& sim) {
        return sim.world.effects.gravity &&
               sim.world.bodies.moving() >= LoadCorrection<Real>::fewest_bodies(heaves_if_slender(sim.world));
    };
    static constexpr auto has_wedged_bodies = [](const Sim& sim) {
        return sim.can_touch() && sim.soft.has_wedged_bodies();
    };
    static constexpr auto has_chains = [](const Sim& sim) {
        return sim.can_touch() && sim.soft.has_chains();
    };
    static constexpr auto has_masses = [](const Sim& sim) {
        return sim.can_touch() && (!sim.world.bodies.mass.is_uniform() || sim.world.bodies.has_flags);
    };
    static constexpr auto has_hits = [](const Sim& sim) { return sim.soft.expects_hits(); };
    static constexpr auto has_struck_contacts = [](const Sim& sim) {
        return sim.soft.has_struck_contacts(sim.world) && bounces(sim);
    };
    static constexpr auto shapes_bounce = [](const Sim& sim) {
        return has_shapes(sim) && sim.world.effects.restitution;
    };
    static constexpr auto has_joints = [](const Sim& sim) { return !sim.world.joints.empty(); };
    static constexpr auto has_built_in_pairs = [](const Sim& sim) {
        return sim.world.joints.may_have_built_in_pairs() && sim.can_touch();
    };
    static constexpr auto has_joints_in_contact = [](const Sim& sim) {
        return !sim.world.joints.empty() && sim.soft.joints.touches() && sim.can_touch();
    };
    static constexpr auto may_gain = [](const Sim& sim) {
        return sim.can_touch() && (!sim.world.joints.empty() || has_shapes(sim) ||
                                   !sim.world.immovable_rows.empty() || sim.soft.takes_gains());
    };
    static constexpr auto has_sensors = [](const Sim& sim) { return sim.world.sensing.is_called_for(); };
    static constexpr auto has_lost_bodies = [](const Sim& sim) { return !sim.lost.empty(); };

    static constexpr Stage<Sim> kBegin[] = {
        {"follow_changes", [](Sim& sim) { sim.follow_changes(); }, has_changes, KernelChoice::none,
         "position, radius, candidate pairs, contacts of shapes",
         "candidate pairs, coloured candidates, contacts of shapes"},
        {"watch_built_in_pairs",
         [](Sim& sim) {
             if (watch_built_in_pairs(sim.world)) sim.candidates.invalidate_pairs();
         },
         has_built_in_pairs, KernelChoice::scalar_f64, "joints, position, angle",
         "joints, pairs that do not touch"},
        {"sort_rows", [](Sim& sim) { sort_rows(sim); }, can_meet, KernelChoice::none, "position",
         "rows of all columns"},
        {"begin_flight", [](Sim& sim) { begin_flight(sim); }, always, KernelChoice::radius,
         "position, velocity",
         "motion, velocity, angular velocity, flags, rows near walls, rows out of margin"},
        {"update_candidates", [](Sim& sim) { update_candidates(sim); }, can_meet, KernelChoice::isa,
         "position, velocity, angle, angular velocity, radius", "candidate pairs"},
        {"wake_sleepers", [](Sim& sim) { wake_sleepers(sim); }, sleeps, KernelChoice::none,
         "position, velocity, candidate pairs", "rows of all columns, supports"},
        {"update_contacts", [](Sim& sim) { update_contacts(sim); }, can_meet, KernelChoice::none,
         "position, candidate pairs", "coloured candidates, impulses"},
        {"begin_substeps",
         [](Sim& sim) {
             sim.soft.begin_substeps(sim.world, sim.motion, sim.flights, sim.substep_dt, sim.world.gravity,
                                     *sim.kernels, sim.executor);
         },
         always, KernelChoice::isa, "motion, angular velocity, mass, radius",
         "velocity records, displacements"},
        {"find_contacts",
         [](Sim& sim) {
             sim.soft.find_contacts(sim.world, sim.edge_candidates, sim.motion,
                                    sim.candidates.flies_together(), sim.longest_substep);
         },
         can_meet, KernelChoice::contacts, "motion, position, velocity, coloured candidates, impulses",
         "contacts, impulses, motion, velocity records, books"},
        {"find_manifolds",
         [](Sim& sim) {
             if (!sim.can_meet()) return sim.soft.paths.manifolds.clear();  // pairs are not kept up to date
             sim.soft.find_manifolds(sim.world, sim.edge_candidates);
         },
         has_shapes, KernelChoice::isa,
         "position, angle, velocity, angular velocity, candidate pairs, impulses of shapes",
         "paths of contacts, velocity records, displacements"},
        {"mark_impacts", [](Sim& sim) { sim.soft.mark_impacts(sim.world, sim.candidates); }, bounces,
         KernelChoice::none, "contacts, velocity", "contacts, impacts"},
        {"rebalance_loads", [](Sim& sim) { sim.soft.rebalance_loads(sim.world.bodies); }, has_lost_loads,
         KernelChoice::none, "contacts, contacts of removed bodies", "impulses"},
        {"warm_start", [](Sim& sim) { sim.soft.warm_start(); }, can_meet, KernelChoice::contacts,
         "contacts, impulses", "velocity records"},
        {"warm_start_paths", [](Sim& sim) { sim.soft.warm_start_paths(sim.world); }, has_shapes,
         KernelChoice::isa, "paths of contacts", "velocity records"},
        {"begin_joints", [](Sim& sim) { sim.soft.begin_joints(sim.world, sim.flights); }, has_joints,
         KernelChoice::scalar_f64, "joints, position, angle, velocity, contacts", "joints, velocity records"},
    };
    static constexpr Stage<Sim> kSubstep[] = {
        {"solve_joints", [](Sim& sim) { sim.soft.solve_joints(sim.world, sim.substep); }, has_joints,
         KernelChoice::isa, "joints, contacts, position, angle, velocity records, displacements",
         "impulses, velocity records, displacements"},
        {"bounce_shapes",
         [](Sim& sim) { sim.soft.carry_out_shape_impacts(sim.world.bodies, sim.world.books); }, shapes_bounce,
         KernelChoice::scalar_f64, "paths of contacts, contacts, position, velocity records, displacements",
         "paths of contacts, contacts, impacts, velocity records, books"},
        {"solve_paths",
         [](Sim& sim) { sim.soft.solve_paths(sim.substep, sim.substep + 1 == sim.substep_count); },
         has_shapes, KernelChoice::isa, "paths of contacts, velocity records",
         "paths of contacts, velocity records, displacements"},
        {"solve_contacts",
         [](Sim& sim) { sim.soft.solve_contacts(sim.substep, sim.substep + 1 == sim.substep_count); },
         can_meet, KernelChoice::contacts, "contacts, velocity records",
         "impulses, velocity records, displacements"},
        {"correct_loads", [](Sim& sim) { sim.soft.correct_loads(sim.flight()); }, may_heave,
         KernelChoice::contacts, "motion, contacts, paths of contacts, velocity records",
         "paths of contacts, impulses, velocity records"},
        {"solve_chains", [](Sim& sim) { sim.soft.solve_chains(); }, has_chains, KernelChoice::scalar_f64,
         "contacts, velocity records", "impulses, velocity records"},
        {"solve_wedged_bodies", [](Sim& sim) { sim.soft.solve_wedged_bodies(); }, has_wedged_bodies,
         KernelChoice::scalar_f64, "contacts, velocity records", "impulses, velocity records"},
        {"solve_uneven_contacts",
         [](Sim& sim) { sim.soft.solve_uneven_contacts(sim.substep + 1 == sim.substep_count); }, has_masses,
         KernelChoice::scalar_f64, "contacts, velocity records", "impulses, velocity records, displacements"},
        {"solve_deep_contacts", [](Sim& sim) { sim.soft.solve_deep_contacts(); }, has_hits,
         KernelChoice::contacts, "contacts, velocity records, displacements",
         "impulses, velocity records, displacements"},
        {"solve_joints_and_contacts", [](Sim& sim) { sim.soft.solve_joints_and_contacts(sim.world); },
         has_joints_in_contact, KernelChoice::contacts, "joints, contacts, velocity records, displacements",
         "impulses, velocity records, displacements"},
        {"bound_energy", [](Sim& sim) { sim.soft.bound_energy(sim.world); }, may_gain, KernelChoice::none,
         "joints, contacts, velocity records", "impulses, velocity records"},
        {"book_joints", [](Sim& sim) { sim.soft.end_joints_of_substep(sim.world, sim.world.books); },
         has_joints, KernelChoice::none, "joints, velocity records", "joints, books"},
        {"book_substep", [](Sim& sim) { sim.soft.book_substep(sim.world, sim.world.books); }, has_books,
         KernelChoice::none, "joints, contacts, velocity records", "books"},
        {"carry_out_impacts",
         [](Sim& sim) {
             sim.soft.carry_out_impacts(sim.world, sim.motion, sim.world.books, sim.interruption);
         },
         bounces, KernelChoice::scalar_f64, "impacts, impulses, motion, velocity records, displacements",
         "impulses, velocity records, displacements, contacts, books"},
        {"settle_struck_contacts",
         [](Sim& sim) { sim.soft.settle_struck_contacts(sim.world, sim.motion, sim.world.books); },
         has_struck_contacts, KernelChoice::contacts,
         "impacts, motion, contacts, velocity records, displacements",
         "contacts, impulses, velocity records, books"},
        {"advance_bodies",
         [](Sim& sim) {
             sim.soft.advance_bodies(sim.substep, sim.substep + 1 == sim.substep_count,
                                     !sim.world.joints.empty());
         },
         always, KernelChoice::isa, "velocity records, impulses",
         "velocity records, displacements, impulses"},
    };
    static constexpr Stage<Sim> kEnd[] = {
        {"end_joints", [](Sim& sim) { end_joints(sim); }, has_joints, KernelChoice::scalar_f64,
         "joints, contacts, position, angle, velocity records, displacements",
         "joints, velocity records, displacements, books"},
        {"end_contacts", [](Sim& sim) { sim.soft.end_contacts(); }, can_meet, KernelChoice::none, "contacts",
         "impulses"},
        {"project_positions", [](Sim& sim) { sim.soft.project_positions(sim.world, sim.flight()); }, can_meet,
         KernelChoice::none, "motion, candidate pairs, displacements", "displacements"},
        {"end_substeps", [](Sim& sim) { sim.soft.end_substeps(sim.world.bodies, sim.lost_rows, sim.lost); },
         always, KernelChoice::isa, "velocity records, displacements",
         "position, velocity, angle, angular velocity"},
        {"undo_tunnelling", [](Sim& sim) { undo_tunnelling(sim); }, has_edges_or_shapes, KernelChoice::none,
         "motion, position, edges, contacts of shapes", "position, angle, velocity, books"},
        {"clamp_to_walls", [](Sim& sim) { clamp_to_walls(sim); }, has_walls, KernelChoice::none,
         "motion, position", "position, velocity, books"},
        {"quarantine_bodies", [](Sim& sim) { quarantine_bodies(sim); }, has_lost_bodies, KernelChoice::none,
         "rows out of the limits", "velocity, angular velocity, flags"},
        {"book_displacements",
         [](Sim& sim) { sim.soft.book_displacements(sim.world, sim.motion, sim.world.books); }, has_ledger,
         KernelChoice::none, "motion, position, contacts, paths of contacts, impulses", "books"},
        {"sense", [](Sim& sim) { sense(sim); }, has_sensors, KernelChoice::scalar_f64,
         "position, angle, velocity, angular velocity, candidate pairs, bodies in sensors",
         "bodies in sensors, events"},
        {"put_to_sleep", [](Sim& sim) { put_to_sleep(sim); }, sleeps, KernelChoice::none,
         "velocity, angular velocity, coloured candidates, impulses",
         "rows of all columns, velocity, angular velocity, books"},
        {"check_energy",
         [](Sim& sim) { check_energy(sim.world, sim.substep_count, {.passive = has_discs_alone(sim)}); },
         has_ledger, KernelChoice::scalar_f64, "position, velocity, angular velocity, joints, books",
         "books"},
    };
    static constexpr std::size_t kFirstOfSubstep = std::size(kBegin),
                                 kFirstOfEnd = kFirstOfSubstep + std::size(kSubstep);
    static_assert(kFirstOfEnd + std::size(kEnd) <= StageTimes::kMostStages);

    /// @return false if it was interrupted: the world is as it was at the start of the flight
    template <class Watch>
    [[gnu::always_inline]] static bool fly(Sim& sim, Watch& watch) {
        sim.set_flight();
        sim.keep_start_of_flight();
        bool goes_on = run_interruptible(kBegin, 0, sim, watch);
        for (sim.substep = 0; goes_on && sim.substep < sim.substep_count; ++sim.substep)
            goes_on = run_interruptible(kSubstep, kFirstOfSubstep, sim, watch);
        if (!goes_on) return false;
        run_stages(kEnd, kFirstOfEnd, sim, watch);
        sim.flights.end_flight();
        return true;
    }

    template <class Watch>
    void step(double dt, Watch& watch) {
        Sim& sim = *this;
        const double start = sim.world.time;
        if (sim.has_anything_to_move()) {
            if (!sim.can_touch()) sim.drop_contacts();
            sim.begin_flights(dt);
            watch.start();
            bool goes_on = true;
            while (goes_on && !sim.flights.are_done()) {
                goes_on = fly(sim, watch);
                sim.world.time = start + sim.flights.elapsed();
            }
            watch.finish();
            if (!goes_on) return sim.take_back_flight();
        } else {
            sim.world.time += dt;
        }
        ++sim.step_count;
    }

  public:
    explicit SoftStep(bool is_rattle = false) { this->soft.joints.is_rattle = is_rattle; }

    void step(double dt) override { step(dt, this->times); }
    void step_observed(double dt, StageObserver& observer) override { step(dt, observer); }
    void report_stages(StageVisitor visit) const override {
        visit_stages<Sim>(*this, visit, kBegin);
        visit_stages<Sim>(*this, visit, kSubstep, kFirstOfSubstep);
        visit_stages<Sim>(*this, visit, kEnd, kFirstOfEnd);
    }
};

}  // namespace

template <>
std::unique_ptr<Simulation<float>> make_soft_simulation() {
    return std::make_unique<SoftStep<float>>();
}
template <>
std::unique_ptr<Simulation<double>> make_soft_simulation() {
    return std::make_unique<SoftStep<double>>();
}

template <>
std::unique_ptr<Simulation<float>> make_rattle_simulation() {
    return std::make_unique<SoftStep<float>>(true);
}
template <>
std::unique_ptr<Simulation<double>> make_rattle_simulation() {
    return std::make_unique<SoftStep<double>>(true);
}

}  // namespace carom

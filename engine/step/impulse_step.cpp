#include "solvers/impulse/stages.hpp"
#include "solvers/shared/candidate_stages.hpp"
#include "solvers/shared/check_energy.hpp"
#include "stages/stage.hpp"
#include "step/make_simulation.hpp"

// THE STEP of solver `impulse`: each impact at its own time. docs/how-a-step-works.md has a paragraph on each
// line.

namespace carom {
namespace {

template <class Real>
class ImpulseStep final : public ImpulseSimulation<Real> {
    using Sim = ImpulseSimulation<Real>;
    static constexpr auto always = [](const Sim&) { return true; };
    static constexpr auto can_meet = [](const Sim& sim) { return sim.can_meet(); };
    static constexpr auto has_ledger = [](const Sim& sim) { return sim.world.books.is_open; };
    static constexpr auto has_rotation = [](const Sim& sim) { return sim.world.effects.rotation; };

    static constexpr Stage<Sim> kSubstep[] = {
        {"sort_rows",
         [](Sim& sim) {
             sort_rows_by_place(
                 sim, [&](auto) { sim.impulse.columns.accelerations.clear(), sim.knows_standing = false; });
         },
         can_meet, KernelChoice::none, "position", "rows of all columns"},
        {"begin_flight", [](Sim& sim) { begin_flight(sim); }, always, KernelChoice::radius,
         "position, velocity",
         "motion, velocity, angular velocity, flags, rows near walls, rows out of margin"},
        {"update_candidates", [](Sim& sim) { find_candidate_pairs(sim, sim.impulse.flights.end); }, can_meet,
         KernelChoice::isa, "position, velocity, angle, angular velocity, radius", "candidate pairs"},
        {"find_impacts", [](Sim& sim) { find_impacts(sim); }, can_meet, KernelChoice::radius,
         "motion, candidate pairs", "meetings"},
        {"settle_contacts", [](Sim& sim) { sim.impulse.settle_contacts(sim.meetings, sim.world.handles); },
         can_meet, KernelChoice::none, "meetings, motion", "motion, accelerations, impact queue"},
        {"resolve_impacts", [](Sim& sim) { sim.impulse.resolve_impacts(sim.executor); }, can_meet,
         KernelChoice::none, "impact queue, motion, candidate pairs, angle, angular velocity",
         "motion, angle, angular velocity, books"},
        {"keep_books", [](Sim& sim) { keep_books(sim); }, has_ledger, KernelChoice::none,
         "motion, angular velocity", "books"},
        {"advance_rotation", [](Sim& sim) { advance_rotation(sim); }, has_rotation, KernelChoice::isa,
         "angular velocity", "angle, angular velocity"},
        {"end_flight", [](Sim& sim) { end_flight(sim); }, always, KernelChoice::isa, "motion, accelerations",
         "position, velocity"},
        {"check_energy",
         [](Sim& sim) {
             // Forces of contacts at rest are iterated, and end slow separations.
             const bool may_rest = length_squared(sim.world.gravity) > 0;
             check_energy(sim.world, 1, {.restitution = !may_rest, .correction = true, .passive = true});
         },
         has_ledger, KernelChoice::scalar_f64, "position, velocity, angular velocity, joints, books",
         "books"},
    };

    template <class Watch>
    void step(double dt, Watch& watch) {
        if (this->has_anything_to_move()) {
            const int substeps = this->substeps_for_drag(dt);
            this->flight_dt = dt / substeps;
            watch.start();
            for (int i = 0; i < substeps; ++i) {
                this->forget_start_of_substep();
                if (run_interruptible(kSubstep, 0, static_cast<Sim&>(*this), watch)) continue;
                this->take_back_substep();
                this->world.time += i * this->flight_dt;
                watch.finish();
                return;
            }
            watch.finish();
        }
        this->world.time += dt;
        ++this->step_count;
    }

  public:
    void step(double dt) override { step(dt, this->times); }
    void step_observed(double dt, StageObserver& observer) override { step(dt, observer); }
    void report_stages(StageVisitor visit) const override { visit_stages<Sim>(*this, visit, kSubstep); }
};

}  // namespace

template <>
std::unique_ptr<Simulation<float>> make_impulse_simulation() {
    return std::make_unique<ImpulseStep<float>>();
}
template <>
std::unique_ptr<Simulation<double>> make_impulse_simulation() {
    return std::make_unique<ImpulseStep<double>>();
}

}  // namespace carom

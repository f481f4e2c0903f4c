#include "step/step.hpp"

#include "solvers/shared/stages.hpp"

namespace carom {

// THE STEP. Each line is a stage of engine/solvers/; docs/how-a-step-works.md has a paragraph on each. A
// stage that the scene does not call for is null in the plan.
template <class Real>
void step(Simulation<Real>& sim, double dt, StageTimes& times) {
    const StepPlan<Real> plan = make_step_plan(sim, dt);
    const auto run = [&](StageName name, void (*stage)(Simulation<Real>&)) {
        if (!stage) return;
        stage(sim);
        times.lap(name);
    };

    // A flight is what the broadphase looks ahead: solver `impulse` takes one a substep, `soft` one a step.
    sim.flight_dt = plan.flights > 0 ? dt / plan.flights : dt;
    sim.substep_count = plan.contact_substeps;
    sim.substep_dt = plan.contact_substeps > 0 ? dt / plan.contact_substeps : 0;
    times.start();
    for (int i = 0; i < plan.flights; ++i) {
        run(StageName::sort_rows, plan.sort_rows);
        run(StageName::begin_flight, plan.begin_flight);
        run(StageName::update_candidates, plan.update_candidates);
        run(StageName::wake_sleepers, plan.wake_sleepers);

        run(StageName::find_impacts, plan.find_impacts);
        run(StageName::settle_contacts, plan.settle_contacts);
        run(StageName::resolve_impacts, plan.resolve_impacts);
        run(StageName::keep_books, plan.keep_books);
        run(StageName::advance_rotation, plan.advance_rotation);
        run(StageName::end_flight, plan.end_flight);
        run(StageName::run_events, plan.run_events);
    }
    run(StageName::update_contacts, plan.update_contacts);
    run(StageName::begin_substeps, plan.begin_substeps);
    run(StageName::find_contacts, plan.find_contacts);
    for (sim.substep = 0; sim.substep < plan.contact_substeps; ++sim.substep) {
        run(StageName::solve_contacts, plan.solve_contacts);
        run(StageName::book_substep, plan.book_substep);
        run(StageName::advance_bodies, plan.advance_bodies);
    }
    run(StageName::end_contacts, plan.end_contacts);
    run(StageName::end_substeps, plan.end_substeps);
    run(StageName::book_displacements, plan.book_displacements);
    run(StageName::put_to_sleep, plan.put_to_sleep);
    sim.world.time += dt;
    ++sim.step_count;
}

template void step(Simulation<float>&, double, StageTimes&);
template void step(Simulation<double>&, double, StageTimes&);

}  // namespace carom

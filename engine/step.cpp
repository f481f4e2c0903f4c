#include "step.hpp"

#include "stages/stages.hpp"

namespace carom {

// THE STEP. Each line is a stage of engine/stages/; docs/how-a-step-works.md has a paragraph on each. A stage
// that the scene does not call for is null in the plan.
template <class Real>
void step(Simulation<Real>& sim, double dt, StageTimes& times) {
    const StepPlan<Real> plan = make_step_plan(sim, dt);
    const auto run = [&](StageName name, void (*stage)(Simulation<Real>&)) {
        if (!stage) return;
        stage(sim);
        times.lap(name);
    };

    sim.h = dt / plan.substeps;
    times.start();
    for (int i = 0; i < plan.substeps; ++i) {
        run(StageName::sort_rows, plan.sort_rows);
        run(StageName::begin_flight, plan.begin_flight);
        run(StageName::update_candidates, plan.update_candidates);
        run(StageName::find_impacts, plan.find_impacts);
        run(StageName::settle_contacts, plan.settle_contacts);
        run(StageName::resolve_impacts, plan.resolve_impacts);
        run(StageName::keep_books, plan.keep_books);
        run(StageName::advance_rotation, plan.advance_rotation);
        run(StageName::end_flight, plan.end_flight);
        run(StageName::run_events, plan.run_events);
    }
    sim.world.time += dt;
    ++sim.step_count;
}

template void step(Simulation<float>&, double, StageTimes&);
template void step(Simulation<double>&, double, StageTimes&);

}  // namespace carom

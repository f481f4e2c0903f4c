#include "solvers/event/event_simulation.hpp"
#include "solvers/shared/check_energy.hpp"
#include "stages/stage.hpp"
#include "step/make_simulation.hpp"

// THE STEP of solver `event`: from impact to impact, however long the step. docs/how-a-step-works.md has a
// paragraph on each line.

namespace carom {
namespace {

template <class Real>
class EventStep final : public EventSimulation<Real> {
    using Sim = EventSimulation<Real>;

    static constexpr Stage<Sim> kStep[] = {
        {"run_events", [](Sim& sim) { run_events(sim); }, [](const Sim&) { return true; },
         KernelChoice::scalar_f64, "all columns", "position, velocity, angle, angular velocity, books"},
        {"check_energy", [](Sim& sim) { check_energy(sim.world, 1, {.correction = true, .passive = true}); },
         [](const Sim& sim) { return sim.world.books.is_open; }, KernelChoice::scalar_f64,
         "position, velocity, angular velocity, joints, books", "books"},
    };

    template <class Watch>
    void step(double dt, Watch& watch) {
        if (this->has_anything_to_move()) {
            this->flight_dt = dt;
            watch.start();
            run_stages(kStep, 0, static_cast<Sim&>(*this), watch);
            watch.finish();
            if (this->interruption.has_stopped()) {
                this->world.time += this->flight_dt;
                return;
            }
        }
        this->world.time += dt;
        ++this->step_count;
    }

  public:
    void step(double dt) override { step(dt, this->times); }
    void step_observed(double dt, StageObserver& observer) override { step(dt, observer); }
    void report_stages(StageVisitor visit) const override { visit_stages<Sim>(*this, visit, kStep); }
};

}  // namespace

template <>
std::unique_ptr<Simulation<float>> make_event_simulation() {
    return std::make_unique<EventStep<float>>();
}
template <>
std::unique_ptr<Simulation<double>> make_event_simulation() {
    return std::make_unique<EventStep<double>>();
}

}  // namespace carom

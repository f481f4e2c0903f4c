#pragma once

#include <vector>

#include "solvers/event/event_dynamics.hpp"
#include "solvers/shared/simulation.hpp"

namespace carom {

/// A world that solver `event` steps: it keeps discs in an order and a precision of its own; the columns are
/// written at the end of each step.
template <class Real>
class EventSimulation : public Simulation<Real> {
  public:
    EventSimulation() : Simulation<Real>(MarginRule::common) {}

    Solver solver() const override { return Solver::event; }
    bool has_long_loops() const override { return false; }
    void forget_derived_state() override;
    /// Hands the bodies over if they have changed. @throws Error (inconsistent) if two of them, or one and a
    /// wall, overlap
    void check_bodies(std::string_view where) override;
    void report(Profile& profile) const override;
    std::size_t bytes() const override;
    void visit_state(StateSize& archive) const override { visit_all(*this, archive); }
    void visit_state(StateWriter& archive) const override { visit_all(*this, archive); }
    void visit_state(StateReader& archive) override { visit_all(*this, archive); }

    EventDynamics events;
    std::vector<std::int32_t> event_rows;  ///< the world's rows that `events` has; empty: they have changed

  private:
    template <class Self, class Archive>
    static void visit_all(Self& self, Archive& archive) {
        Simulation<Real>::visit_common(self, archive);
        archive(self.events, self.event_rows);
    }
};

/// A stage: goes from impact to impact to the end of the step, or as far as `sim.interruption` lets it; sets
/// `sim.flight_dt` to the time that it came.
template <class Real>
void run_events(EventSimulation<Real>& sim);

extern template class EventSimulation<float>;
extern template class EventSimulation<double>;

}  // namespace carom

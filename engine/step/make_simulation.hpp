#pragma once

#include <memory>

#include "solvers/shared/simulation.hpp"

namespace carom {

/// A simulation with an empty world and the step of a solver.
/// @param solver  impulse, soft, rattle or event
template <class Real>
std::unique_ptr<Simulation<Real>> make_simulation(Solver solver);

// The same for each solver: at the end of the page that has its step.
template <class Real>
std::unique_ptr<Simulation<Real>> make_impulse_simulation();
template <class Real>
std::unique_ptr<Simulation<Real>> make_soft_simulation();
/// The step of `soft` without contacts.
template <class Real>
std::unique_ptr<Simulation<Real>> make_rattle_simulation();
template <class Real>
std::unique_ptr<Simulation<Real>> make_event_simulation();

/// Tells of the stages of a list; `first` is the number of its first stage for the stopwatch.
template <class Sim, std::size_t kCount>
void visit_stages(const Sim& sim, StageVisitor visit, const Stage<Sim> (&stages)[kCount],
                  std::size_t first = 0) {
    for (std::size_t i = 0; i < kCount; ++i) {
        const Stage<Sim>& stage = stages[i];
        visit({stage.name, stage.reads, stage.writes, stage.kernel,
               sim.has_anything_to_move() && stage.is_called_for(sim), sim.times[first + i]});
    }
}

}  // namespace carom

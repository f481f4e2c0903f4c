#pragma once

#include "solvers/shared/simulation.hpp"

namespace carom {

/// The stages of one step; null = the scene does not call for it.
template <class Real>
struct StepPlan {
    using Stage = void (*)(Simulation<Real>&);

    int flights = 0;           ///< that the broadphase looks ahead
    int contact_substeps = 0;  ///< of solver `soft`
    Stage sort_rows = nullptr;
    Stage begin_flight = nullptr;
    Stage update_candidates = nullptr;
    Stage wake_sleepers = nullptr;
    Stage find_impacts = nullptr;
    Stage settle_contacts = nullptr;
    Stage resolve_impacts = nullptr;
    Stage keep_books = nullptr;
    Stage advance_rotation = nullptr;
    Stage end_flight = nullptr;
    Stage run_events = nullptr;

    // Solver `soft`.
    Stage update_contacts = nullptr;
    Stage begin_substeps = nullptr;
    Stage find_contacts = nullptr;
    Stage solve_contacts = nullptr;
    Stage advance_bodies = nullptr;
    Stage book_substep = nullptr;
    Stage end_contacts = nullptr;
    Stage book_displacements = nullptr;
    Stage end_substeps = nullptr;
    Stage put_to_sleep = nullptr;
};

/// Which effects a scene calls for, its overrides applied, each with the reason.
struct CalledEffects {
    Effects effects;
    std::vector<EffectReport> reports;
    std::string solver_reason;  ///< why the world has its solver
};
CalledEffects call_effects(const Scene& scene, const EffectOverrides& overrides);

/// What the next step runs: a few look-ups, nothing cached, so nothing stale.
template <class Real>
StepPlan<Real> make_step_plan(const Simulation<Real>& sim, double dt);

/// The plan in words, for `World::plan()`.
template <class Real>
Plan describe_plan(Simulation<Real>& sim, const CalledEffects& called);

extern template StepPlan<float> make_step_plan(const Simulation<float>&, double);
extern template StepPlan<double> make_step_plan(const Simulation<double>&, double);
extern template Plan describe_plan(Simulation<float>&, const CalledEffects&);
extern template Plan describe_plan(Simulation<double>&, const CalledEffects&);

}  // namespace carom

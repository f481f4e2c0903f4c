#pragma once

#include <carom/accuracy.hpp>

#include <cstdint>
#include <vector>

#include "broadphase/candidates.hpp"
#include "broadphase/edge_candidates.hpp"
#include "isa/kernel_table.hpp"
#include "parallel/executor.hpp"
#include "sleeping/sleepers.hpp"
#include "solvers/event/event_dynamics.hpp"
#include "solvers/impulse/impulse_solver.hpp"
#include "solvers/soft/soft_solver.hpp"
#include "state/chunked_list.hpp"
#include "state/world_state.hpp"

namespace carom {

/// All a running world consists of. The stages of this folder work on it, in the order that step.cpp states.
template <class Real>
struct Simulation {
    WorldState<Real> world;
    Candidates<Real> candidates;
    EdgeCandidates<Real> edge_candidates;  ///< solver `soft`
    ImpulseSolver<Real> impulse;
    SoftSolver<Real> soft;
    Sleepers<Real> sleepers;
    Executor executor;
    const KernelTable<Real>* kernels = nullptr;
    Solver solver = Solver::impulse;       ///< never `automatic`
    EventDynamics events;                  ///< of solver `event`
    std::vector<std::int32_t> event_rows;  ///< the world's rows it has; empty: they have changed
    int substeps_asked_for = 1;            ///< what was asked for; strong drag can make a step take more

    // Solver `soft`: a step is one flight for the broadphase, cut into substeps for the contacts.
    int substep = 0, substep_count = 1;
    double substep_dt = 0;               ///< s
    std::int64_t graph_of_rebuild = -1;  ///< which candidate pairs the contact graph was made of

    // Of the present substep (solver `soft`: of the step).
    double flight_dt = 0;               ///< s
    double fastest = 0;                 ///< m/s, at the start, of all bodies
    std::vector<double> chunk_fastest;  ///< m²/s², by chunk
    std::vector<std::int32_t> displaced, lost;
    ChunkedList wall_rows, displaced_rows, lost_rows;
    std::vector<FoundMeeting> meetings;                     ///< that the solver has to look at
    std::vector<std::vector<FoundMeeting>> chunk_meetings;  ///< where chunks run on several threads
    std::vector<Real> immovable_spins;                      ///< rad/s, kept over the turn

    std::int64_t step_count = 0;

    /// To be called when rows, masses or laws have changed outside of a step.
    void forget_derived_state() {
        candidates.invalidate();
        impulse.forget_contacts();
        impulse.flights.accelerations.clear();
        event_rows.clear();
        soft.forget_rows();
    }
};

}  // namespace carom

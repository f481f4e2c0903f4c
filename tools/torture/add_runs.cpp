#include "torture/add_runs.hpp"

#include <carom/errors.hpp>

#include <algorithm>

#include "torture/runs.hpp"

namespace carom::torture {
namespace {

/// The solver that runs. @throws carom::Error if it refuses the scene
std::string solver_of(const Scene& scene, Solver solver, Precision precision) {
    return Watch(scene, solver, precision, 1).simulation().plan().solver;
}

/// Empty, or what it says of a scene that it does not take.
std::string refusal_of(const Scene& scene, Solver solver, Precision precision) {
    try {
        solver_of(scene, solver, precision);
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

Outcome run_one(const Trial& trial, Solver solver, Precision precision, bool has_automatic) {
    const Scene scene = trial.make();
    if (solver != Solver::automatic) {  // that may not refuse: its error is a failure
        const std::string refusal = refusal_of(scene, solver, precision);
        if (!refusal.empty()) return {.failure = refusal, .status = Status::refused};
        if (has_automatic &&
            solver_of(scene, solver, precision) == solver_of(scene, Solver::automatic, precision))
            return {.status = Status::as_auto};
    }
    return trial.run(scene, solver, precision);
}

}  // namespace

void add_runs(std::vector<Task>& tasks, const Trial& trial) {
    const bool has_automatic =
        std::find(trial.solvers.begin(), trial.solvers.end(), Solver::automatic) != trial.solvers.end();
    for (const Precision precision : trial.precisions)
        for (const Solver solver : trial.solvers) {
            const bool is_said_twice = solver == Solver::pairwise && precision != trial.precisions.back();
            if (is_said_twice) continue;  // it knows double precision alone
            tasks.push_back({trial.case_id, trial.scene, std::string(carom::name_of(solver)),
                             name_of(solver == Solver::pairwise ? Precision::double_ : precision),
                             [trial, solver, precision, has_automatic] {
                                 return run_one(trial, solver, precision, has_automatic);
                             }});
        }
}

}  // namespace carom::torture

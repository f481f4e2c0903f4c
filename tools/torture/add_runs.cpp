#include "torture/add_runs.hpp"

#include <algorithm>

#include "torture/runs.hpp"

namespace carom::torture {
namespace {

/// The solver that runs. @throws carom::Error if it refuses the scene
std::string solver_of(const Scene& scene, Solver solver, Precision precision) {
    return Watch(scene, solver, precision, 1).simulation().plan().solver;
}

}  // namespace

void add_runs(std::vector<Task>& tasks, const Trial& trial) {
    const bool has_automatic =
        std::find(trial.solvers.begin(), trial.solvers.end(), Solver::automatic) != trial.solvers.end();
    for (const Precision precision : trial.precisions)
        for (const Solver solver : trial.solvers)
            tasks.push_back({trial.case_id, trial.scene, std::string(carom::name_of(solver)),
                             name_of(solver == Solver::pairwise ? Precision::double_ : precision),
                             [trial, solver, precision, has_automatic]() -> Outcome {
                                 const Scene scene = trial.make();
                                 const std::string runs = solver_of(scene, solver, precision);
                                 if (has_automatic && solver != Solver::automatic &&
                                     runs == solver_of(scene, Solver::automatic, precision))
                                     return {.is_skipped = true};
                                 return trial.run(scene, solver, precision);
                             }});
}

}  // namespace carom::torture

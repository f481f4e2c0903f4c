#pragma once

#include <functional>
#include <string>
#include <vector>

#include "torture/case.hpp"
#include "torture/watch.hpp"

namespace carom::torture {

/// A scene, and what is done with it under each of some solvers.
struct Trial {
    std::string case_id, scene;
    std::vector<Solver> solvers;
    std::vector<Precision> precisions;
    std::function<Scene()> make;
    std::function<Outcome(const Scene&, Solver, Precision)> run;
};

/// Appends a task for each solver and precision. A run under a solver that `auto` takes is skipped where
/// there is one under `auto`: it is the same.
void add_runs(std::vector<Task>& tasks, const Trial& trial);

}  // namespace carom::torture

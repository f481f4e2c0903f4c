#pragma once

#include <functional>
#include <string>
#include <vector>

#include "torture/add_runs.hpp"
#include "torture/runs.hpp"

// What `impacts` is made of; one file each.

namespace carom::torture {

void add_impacts_in_line(std::vector<Task>& all, const Options& asked);
void add_gases(std::vector<Task>& all, const Options& asked);
void add_squeezes(std::vector<Task>& all, const Options& asked);

using Run = std::function<Outcome(const Scene&, Solver, Precision)>;

/// Under `auto` and every solver but the naive one.
inline void add_impacts(std::vector<Task>& all, const Options& asked, std::string scene,
                        std::vector<Precision> precisions, std::function<Scene()> make, Run run) {
    add_runs(all,
             {.case_id = "impacts",
              .scene = std::move(scene),
              .solvers = solvers_of(asked, {Solver::automatic, Solver::soft, Solver::impulse, Solver::event}),
              .precisions = std::move(precisions),
              .make = std::move(make),
              .run = std::move(run)});
}

}  // namespace carom::torture

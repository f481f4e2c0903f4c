#include <memory>

#include "torture/add_runs.hpp"
#include "torture/hard/hard_case.hpp"
#include "torture/runs.hpp"
#include "torture/watched_run.hpp"

namespace carom::torture {
namespace {

Outcome run(const HardCase& of, const Scene& scene, Solver solver, Precision precision, double limit) {
    WatchedRun run(scene, solver, precision, limit);
    Outcome outcome{.measures = of.run(run)};
    outcome.failure = run.watch().failure();
    tell_times(outcome, run.watch());
    return outcome;
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    for (const HardCase& each : all_hard_cases({.is_short = asked.is_quick}))
        if (is_named(asked, each.code))
            add_runs(all, {.case_id = "hard",
                           .scene = each.code + " " + each.name,
                           .solvers = solvers_of(asked, every_solver_for(each.make())),
                           .precisions = precisions_of(asked),
                           .make = each.make,
                           .run = [each, limit = asked.limit](const Scene& scene, Solver solver,
                                                              Precision precision) {
                               return run(each, scene, solver, precision, limit);
                           }});
    return all;
}

}  // namespace

Case hard() {
    return {.id = "hard",
            .title = "the matrix: hard cases under every solver; a number and its mark, ! beyond it",
            .is_matrix = true,
            .tasks = tasks};
}

}  // namespace carom::torture

#include "accuracy/solvers.hpp"

#include <carom/accuracy.hpp>

#include <algorithm>

namespace carom::accuracy {
namespace {

constexpr Precision kSingle = Precision::single_, kDouble = Precision::double_;

const std::vector<SweptSolver> kSolvers{
    {Solver::event,
     {kSingle, kDouble},
     false,
     {1},
     {1},
     "goes from impact to impact at their exact times, so it has no step error at all, and its time follows "
     "the "
     "number of impacts; what should rest it cannot hold"},
    {Solver::impulse,
     {kSingle, kDouble},
     true,
     {1, 2, 4},
     {1},
     "flies exactly between impacts and finds each one's time inside the step, so free flight and bounces "
     "cost no "
     "accuracy and long steps are cheap; it has no friction"},
    {Solver::soft,
     {kSingle, kDouble},
     true,
     {4, 1, 2, 8, 16},
     {1},
     "holds contacts at rest with friction, which the others cannot; impacts take effect where a step ends, "
     "so "
     "bounces are first order in the step"},
    {Solver::pairwise,
     {kDouble},
     true,
     {1},
     {1},
     "is where it all started: every pair, one impulse, then apart; first order at best, for comparison"},
};

/// Up to four of the steps, the ends among them.
std::vector<double> fewer(const std::vector<double>& steps) {
    if (steps.size() <= 3) return steps;
    return {steps.front(), steps[steps.size() / 2], steps.back()};
}

}  // namespace

std::span<const SweptSolver> swept_solvers() {
    return kSolvers;
}

std::vector<Setting> settings_of(const Case& asked, bool quick) {
    std::vector<Setting> settings;
    const auto add = [&](const Setting& setting) {
        if (std::find(settings.begin(), settings.end(), setting) == settings.end())
            settings.push_back(setting);
    };
    const std::vector<double> steps = quick ? fewer(asked.steps) : asked.steps;
    const double middle = steps[steps.size() / 2];
    for (const SweptSolver& swept : kSolvers) {
        const auto& wanted = asked.solvers;
        if (std::find(wanted.begin(), wanted.end(), name_of(swept.solver)) == wanted.end()) continue;
        const int substeps = swept.substeps.front(), iterations = swept.iterations.front();
        for (const Precision precision : swept.precisions) {
            if (!swept.has_steps) {
                add({swept.solver, precision, steps.front(), substeps, iterations});
                continue;
            }
            for (const double dt : steps) add({swept.solver, precision, dt, substeps, iterations});
            const std::vector<int> parts =
                quick ? std::vector{swept.substeps.front(), swept.substeps.back()} : swept.substeps;
            for (const int n : parts) add({swept.solver, precision, middle, n, iterations});
            for (const int n : swept.iterations) add({swept.solver, precision, middle, substeps, n});
        }
    }
    return settings;
}

}  // namespace carom::accuracy

#include "accuracy/solvers.hpp"

#include <carom/accuracy.hpp>

#include <algorithm>

#include "accuracy/engines.hpp"

namespace carom::accuracy {
namespace {

constexpr Precision kSingle = Precision::single_, kDouble = Precision::double_;

const std::vector<SweptSolver> kOurs{
    {Solver::event,
     {kSingle, kDouble},
     false,
     {1},
     {1},
     "goes from impact to impact at their exact times, so it has no step error at all, and its time "
     "follows the number of impacts; what should rest it cannot hold"},
    {Solver::impulse,
     {kSingle, kDouble},
     true,
     {1, 2, 4},
     {1},
     "flies exactly between impacts and finds each one's time inside the step, so free flight and bounces "
     "cost no accuracy and long steps are cheap; it has friction in impacts alone"},
    {Solver::soft,
     {kSingle, kDouble},
     true,
     {4, 1, 2, 8, 16},
     {1},
     "holds contacts at rest with friction, shapes and joints, which no other solver here does, by substeps; "
     "impacts are carried out at their own time within a substep",
     true},
    {Solver::rattle,
     {kSingle, kDouble},
     true,
     {4, 1, 2, 8, 16},
     {1},
     "solves joints to round-off with second-order steps that neither gain nor lose energy on the long run; "
     "it "
     "has no contacts"},
    {Solver::pairwise,
     {kDouble},
     true,
     {1},
     {1},
     "is where it all started: every pair, one impulse, then apart; first order at best, for comparison"},
};

/// What the sweeps of the other engines' cases showed (docs/accuracy.md).
std::string_view why_of(std::string_view family) {
    if (family == "Chipmunk")
        return "is a game engine: ten iterations a step, warm starting, double precision";
    if (family == "Box2D 3") return "is a game engine: soft contacts in substeps, single precision";
    return "is a game engine: iterated impulses, then positions, single precision";
}

std::vector<SweptSolver> all_solvers() {
    std::vector<SweptSolver> solvers = kOurs;
    for (const bench::PeerEngine& engine : engines())
        solvers.push_back({Solver::automatic,
                           {engine.precision},
                           true,
                           engine.substeps,
                           engine.iterations,
                           std::string(why_of(engine.family)),
                           true,
                           engine.family});
    return solvers;
}

/// Up to four of the steps, the ends among them.
std::vector<double> fewer(const std::vector<double>& steps) {
    if (steps.size() <= 3) return steps;
    return {steps.front(), steps[steps.size() / 2], steps.back()};
}

}  // namespace

std::span<const SweptSolver> swept_solvers() {
    static const std::vector<SweptSolver> solvers = all_solvers();
    return solvers;
}

std::vector<LeftOut> left_out_of(const Case& asked) {
    std::vector<LeftOut> left_out;
    for (const bench::PeerEngine& engine : engines())
        if (std::string why = why_left_out(asked, engine); !why.empty())
            left_out.push_back({engine.family, std::move(why)});
    return left_out;
}

std::vector<Setting> settings_of(const Case& asked, bool quick) {
    std::vector<Setting> settings;
    const auto add = [&](const Setting& setting) {
        if (std::find(settings.begin(), settings.end(), setting) == settings.end())
            settings.push_back(setting);
    };
    const std::vector<double> steps = quick ? fewer(asked.steps) : asked.steps;
    const double middle = steps[steps.size() / 2];
    const std::vector<LeftOut> left_out = left_out_of(asked);
    const auto is_wanted = [&](const SweptSolver& swept) {
        if (swept.engine.empty())
            return std::find(asked.solvers.begin(), asked.solvers.end(), name_of(swept.solver)) !=
                   asked.solvers.end();
        return std::none_of(left_out.begin(), left_out.end(),
                            [&](const LeftOut& out) { return out.engine == swept.engine; });
    };
    const auto values = [&](const std::vector<int>& all) {
        return quick ? std::vector{all.front(), *std::max_element(all.begin(), all.end())} : all;
    };
    for (const SweptSolver& swept : swept_solvers()) {
        if (!is_wanted(swept)) continue;
        const int substeps = swept.substeps.front(), iterations = swept.iterations.front();
        for (const Precision precision : swept.precisions) {
            if (!swept.has_steps) {
                add({swept.solver, precision, steps.front(), substeps, iterations, swept.engine});
                continue;
            }
            for (const double dt : steps)
                add({swept.solver, precision, dt, substeps, iterations, swept.engine});
            for (const int n : values(swept.substeps))
                add({swept.solver, precision, middle, n, iterations, swept.engine});
            for (const int n : values(swept.iterations))
                add({swept.solver, precision, middle, substeps, n, swept.engine});
            // The step alone: its ends with all the work there is. Not for gases, whose points are dear.
            if (!swept.has_residual || asked.members > 1) continue;
            for (const double dt : {steps.front(), steps.back()})
                add({swept.solver, precision, dt, swept.most_substeps(), swept.most_iterations(),
                     swept.engine});
        }
    }
    return settings;
}

}  // namespace carom::accuracy

#include <algorithm>
#include <cmath>

#include "torture/add_runs.hpp"
#include "torture/energy_rule.hpp"
#include "torture/passive_scene.hpp"
#include "torture/runs.hpp"
#include "torture/watch.hpp"

namespace carom::torture {
namespace {

constexpr std::int64_t kStepsARun = 300, kMostBodies = 10'000, kScenes = 2000;
constexpr std::int64_t kStepsALook = 10;  // between two measurements of overlap

Outcome run(const PassiveTraits& traits, Solver solver, Precision precision, const Options& asked) {
    const PassiveScene passive = passive_scene(traits);
    const std::int64_t steps = asked.steps.value_or(kStepsARun);
    Watch watch(passive.scene, solver, precision, asked.limit);
    EnergyBooks books(watch, passive.scene, passive.lowest);
    double overlap = 0;
    std::size_t outside = 0;
    while (watch.steps() < steps && watch.step()) {
        books.look(watch);
        if (watch.steps() % kStepsALook != 0 && watch.steps() != steps) continue;
        overlap = std::fmax(overlap, watch.simulation().overlaps().max);
        outside = std::max(outside, watch.outside(passive.enclosure));
    }
    Outcome outcome{.measures = {{"energy rise", books.rise(), kLargestRise},
                                 {"quarantined", static_cast<double>(watch.quarantined()), 0},
                                 {"outside", static_cast<double>(outside), 0},
                                 {"by restitution", books.restitution_gain()},
                                 {"by correction", books.correction_gain()},
                                 {"restitution excess", books.excess().restitution},
                                 {"correction excess", books.excess().correction},
                                 {"passive excess", books.excess().passive},
                                 {"overlap", overlap}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    for_each_scene(asked, kScenes, [&](std::uint64_t index) {
        const PassiveTraits traits = passive_traits(asked.seed, index, asked.bodies.value_or(kMostBodies));
        add_runs(all, {.case_id = "passive",
                       .scene = in_words(traits),
                       .solvers = solvers_of(
                           asked, {Solver::automatic, Solver::soft, Solver::impulse, Solver::event}),
                       .precisions = {asked.precision.value_or(traits.precision)},
                       .make = [traits] { return passive_scene(traits).scene; },
                       .run = [=](const Scene&, Solver solver,
                                  Precision precision) { return run(traits, solver, precision, asked); }});
    });
    return all;
}

}  // namespace

Case passive() {
    return {.id = "passive",
            .title = "random scenes that nothing drives; overlaps in radii, energies over the first",
            .is_summed_up = true,
            .tasks = tasks};
}

}  // namespace carom::torture

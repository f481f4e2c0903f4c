#include <algorithm>
#include <cmath>

#include "measure/text.hpp"
#include "torture/add_runs.hpp"
#include "torture/crowd_scene.hpp"
#include "torture/energy_rule.hpp"
#include "torture/runs.hpp"
#include "torture/watch.hpp"

namespace carom::torture {
namespace {

constexpr std::int64_t kSteps = 1800;
constexpr double kLargestOverlap = 0.1, kLargestOverlapAtRest = 0.01, kLargestRms = 1e-3;  // radii, m/s
/// Up to here a heap of some twenty layers loses its energy within the run: layers (1 - e) is above 4.
constexpr double kRestsUpTo = 0.8;

std::vector<double> lowest_of(const Scene& scene) {
    std::vector<double> lowest;
    for (const Body& body : scene.bodies) lowest.push_back(std::get<Disc>(body.shape).radius);
    return lowest;
}

double outside_of(const Watch& watch, const Scene& scene) {
    double outside = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        const Vec2 x = watch.state(i).position;
        outside += !(x.x > 0 && x.x < scene.walls->max.x && x.y > 0);
    }
    return outside;
}

Outcome run(const Scene& scene, Solver solver, Precision precision, const Options& asked, bool should_rest) {
    Watch watch(scene, solver, precision, asked.limit);
    EnergyBooks books(watch, scene, lowest_of(scene));
    double overlap = 0, last_overlap = 0, outside = 0;
    const std::int64_t steps = asked.steps.value_or(kSteps);
    while (watch.steps() < steps && watch.step()) {
        books.look(watch);
        last_overlap = watch.simulation().overlaps().max;
        overlap = std::fmax(overlap, last_overlap), outside = std::fmax(outside, outside_of(watch, scene));
    }
    const auto at_rest = [&](double mark) { return should_rest ? std::optional(mark) : std::nullopt; };
    Outcome outcome{.measures = {{"energy rise", books.rise(), kLargestRise},
                                 {"overlap", overlap, kLargestOverlap},
                                 {"at the end", last_overlap, at_rest(kLargestOverlapAtRest)},
                                 {"rms at the end", watch.rms_speed(), at_rest(kLargestRms)},
                                 {"quarantined", static_cast<double>(watch.quarantined()), 0},
                                 {"outside", outside, 0},
                                 {"by restitution", books.restitution_gain()},
                                 {"by correction", books.correction_gain()}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    const std::int64_t discs = asked.bodies.value_or(kCrowd);
    for (const double friction : {0., 0.3})
        for (const double e : {0., .1, .2, .3, .4, .5, .6, .7, .8, .9, .95, .98, .99, 1.}) {
            const bool should_rest = e <= kRestsUpTo && asked.steps.value_or(kSteps) >= kSteps;
            add_runs(all, {.case_id = "drop",
                           .scene = measure::format("e %g friction %g", e, friction),
                           .solvers = solvers_of(asked, {Solver::automatic}),
                           .precisions = {asked.precision.value_or(Precision::single_)},
                           .make =
                               [=] {
                                   Scene scene = falling_crowd(discs, e, friction);
                                   scene.effects.ledger = true;
                                   return scene;
                               },
                           .run =
                               [=](const Scene& scene, Solver solver, Precision precision) {
                                   return run(scene, solver, precision, asked, should_rest);
                               }});
        }
    return all;
}

}  // namespace

Case drop() {
    return {.id = "drop",
            .title = "1,800 discs dropped into an open box; overlaps in radii, energies over the first, m/s",
            .tasks = tasks};
}

}  // namespace carom::torture

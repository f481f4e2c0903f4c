#include <carom/generators.hpp>

#include <algorithm>
#include <cmath>

#include "measure/text.hpp"
#include "torture/add_runs.hpp"
#include "torture/runs.hpp"

namespace carom::torture {
namespace {

constexpr std::int64_t kDiscs = 1000, kColumn = 100;
constexpr std::int64_t kSteps = 1800, kStepsToSleep = 2400;
constexpr double kLargestRms = 1e-3;  // m/s
constexpr double kRadius = 0.5;       // m

/// Frictionless discs at fill .6 on the floor of an open box, let go.
Scene pile_of(std::int64_t discs, double smallest, double restitution) {
    constexpr double kFill = 0.6, kAspect = 0.5;  // height over width
    const double mean_square = (smallest * smallest + smallest * kRadius + kRadius * kRadius) / 3;
    const double area = static_cast<double>(discs) * 3.141592653589793 * mean_square / kFill;
    const double width = std::sqrt(area / kAspect);
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{
        .min = {0, 0}, .max = {width, area / width}, .top = false, .material = material_of(restitution)};
    Gas gas;
    gas.count = discs, gas.radius = {smallest, kRadius}, gas.seed = 1;
    gas.body.material = material_of(restitution);
    add_gas(scene, gas);
    return scene;
}

/// Frictionless discs that touch, one on another.
/// @param shaft  m, clear distance between its sides; 0: there are none
/// @param jitter  m, sideways
Scene column_of(std::int64_t discs, double restitution, double shaft, double jitter) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const bool has_sides = shaft > 0;
    const double half = has_sides ? 0.5 * shaft : 1e5;
    scene.walls = Walls{.min = {-half, 0},
                        .max = {half, 3.0 * static_cast<double>(discs)},
                        .left = has_sides,
                        .right = has_sides,
                        .top = false,
                        .material = material_of(restitution)};
    for (std::int64_t i = 0; i < discs; ++i)
        scene.add(disc_of(kRadius, {i % 2 ? jitter : -jitter, kRadius * (2 * static_cast<double>(i) + 1)}, {},
                          material_of(restitution)));
    return scene;
}

Outcome run_pile(const Scene& scene, Solver solver, Precision precision, const Options& asked) {
    Watch watch(scene, solver, precision, asked.limit);
    while (watch.steps() < asked.steps.value_or(kSteps) && watch.step()) {
    }
    Outcome outcome{.measures = {{"rms at the end", watch.rms_speed(), kLargestRms},
                                 {"overlap", watch.simulation().overlaps().max}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

Outcome run_column(const Scene& scene, Solver solver, Precision precision, const Options& asked) {
    Watch watch(scene, solver, precision, asked.limit);
    double largest = 0, largest_late = 0;
    const std::int64_t steps = asked.steps.value_or(kSteps);
    while (watch.steps() < steps && watch.step()) {
        largest = std::fmax(largest, watch.rms_speed());
        if (3 * watch.steps() > 2 * steps) largest_late = std::fmax(largest_late, watch.rms_speed());
    }
    Outcome outcome{.measures = {{"rms, last third", largest_late, kLargestRms},
                                 {"rms, largest ever", largest},
                                 {"overlap", watch.simulation().overlaps().max}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

Outcome run_to_sleep(const Scene& scene, Solver solver, Precision precision, const Options& asked) {
    Watch watch(scene, solver, precision, asked.limit);
    std::int64_t first_all_asleep = 0;
    const auto bodies = static_cast<std::int64_t>(scene.bodies.size());
    while (watch.steps() < asked.steps.value_or(kStepsToSleep) && watch.step())
        if (first_all_asleep == 0 && watch.simulation().profile().asleep == bodies)
            first_all_asleep = watch.steps();
    const auto awake = static_cast<double>(bodies - watch.simulation().profile().asleep);
    Outcome outcome{.measures = {{"awake", awake, 0},
                                 {"asleep from step", static_cast<double>(first_all_asleep)},
                                 {"rms at the end", watch.rms_speed(), kLargestRms}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

Scene asleep(Scene scene) {
    scene.effects.sleep = true;
    return scene;
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    const std::int64_t discs = asked.bodies.value_or(kDiscs), column = asked.bodies.value_or(kColumn);
    const auto add = [&](std::string name, auto make, auto run) {
        add_runs(all, {.case_id = "rest",
                       .scene = std::move(name),
                       .solvers = solvers_of(asked, {Solver::automatic, Solver::soft}),
                       .precisions = precisions_of(asked),
                       .make = make,
                       .run = [run, asked](const Scene& scene, Solver solver, Precision precision) {
                           return run(scene, solver, precision, asked);
                       }});
    };
    for (const double e : {0., 0.5})
        for (const double smallest : {kRadius, 0.6 * kRadius}) {
            const std::string heap = measure::format("pile of %lld, r %g to %g, e %g",
                                                     static_cast<long long>(discs), smallest, kRadius, e);
            add(
                heap, [=] { return pile_of(discs, smallest, e); }, run_pile);
            add(
                heap + ", sleep", [=] { return asleep(pile_of(discs, smallest, e)); }, run_to_sleep);
        }
    for (const double e : {0., 0.5}) {
        const std::string heap = measure::format("column of %lld, e %g", static_cast<long long>(column), e);
        add(
            heap, [=] { return column_of(column, e, 0, 0); }, run_column);
        add(
            heap + ", in a shaft", [=] { return column_of(column, e, 1.05, 1e-3); }, run_column);
    }
    return all;
}

}  // namespace

Case rest() {
    return {.id = "rest",
            .title = "frictionless piles and columns come to rest and sleep; m/s, overlaps in radii",
            .tasks = tasks};
}

}  // namespace carom::torture

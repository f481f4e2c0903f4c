#include <algorithm>
#include <cmath>
#include <optional>

#include "torture/add_runs.hpp"
#include "torture/energy_rule.hpp"
#include "torture/random.hpp"
#include "torture/restored_run.hpp"
#include "torture/runs.hpp"
#include "torture/watch.hpp"
#include "torture/worlds/traits.hpp"
#include "torture/worlds/world.hpp"

namespace carom::torture {
namespace {

constexpr std::int64_t kStepsARun = 600, kMostBodies = 400, kScenes = 10'000;
constexpr std::int64_t kStepsALook = 10;  // between two measurements of overlap
constexpr double kLargestStall = 20;      // medians

/// Lengths of steps one after the other [s].
class StepLengths {
  public:
    explicit StepLengths(const WorldTraits& traits)
        : traits_(traits), random_(traits.seed ^ 0x9FB21C651E98DF25u, traits.index) {}

    double next() {
        return traits_.dt_ratio > 1 ? random_.log_uniform(traits_.dt, traits_.dt * traits_.dt_ratio)
                                    : traits_.dt;
    }

  private:
    WorldTraits traits_;
    Random random_;
};

/// The same steps give the same bits in the same time, but for what the machine does besides: a step that
/// seems to stall is stepped once more, and the shorter of both times counts.
void time_again(Watch& watch, const WorldTraits& traits, const Options& asked) {
    const Accuracy& how = watch.scene().accuracy;
    Watch again(watch.scene(), how.solver, how.precision, asked.limit);
    StepLengths lengths(traits);
    while (again.steps() < watch.steps() && again.step(lengths.next())) {
    }
    watch.take_shorter_times(again);
}

/// The largest of each so far.
struct Found {
    std::size_t outside = 0, not_finite = 0;
    double overlap = 0, gap = 0;

    void look(const Watch& watch, const RandomWorld& world, double unit) {
        not_finite = std::max(not_finite, watch.not_finite());
        if (world.is_closed)
            outside = std::max(
                outside, watch.outside(world.enclosure, world.drum ? watch.state(*world.drum) : BodyState{}));
        overlap = std::fmax(overlap, watch.simulation().overlaps().max);
        gap = std::fmax(gap, watch.simulation().joint_errors().max / unit);
    }
};

Outcome run(const RandomWorld& world, const WorldTraits& traits, Solver solver, Precision precision,
            const Options& asked) {
    const std::int64_t steps = asked.steps.value_or(kStepsARun);
    Watch watch(world.scene, solver, precision, asked.limit);
    EnergyBooks books(watch, world.scene, world.lowest, world.sources, world.least_energy);
    StepLengths lengths(traits);
    std::optional<RestoredRun> restored;
    Found found;
    while (watch.steps() < steps) {
        const double dt = lengths.next();
        if (!watch.step(dt)) break;
        if (restored) restored->step(dt);
        if (traits.is_restored && watch.steps() == steps / 2) restored.emplace(watch);
        books.look(watch);
        if (watch.steps() % kStepsALook == 0 || watch.steps() == steps) found.look(watch, world, traits.unit);
    }
    if (!watch.gave_up() && watch.stall() > kLargestStall) time_again(watch, traits, asked);
    const bool differs = restored && !restored->agrees_with(watch);
    Outcome outcome{.measures = {{"energy rise", books.rise(), kLargestRise},
                                 {"quarantined", static_cast<double>(watch.quarantined()), 0},
                                 {"outside", static_cast<double>(found.outside), 0},
                                 {"not finite", static_cast<double>(found.not_finite), 0},
                                 {"other bits", differs ? 1. : 0., 0},
                                 {"stall", watch.stall(), kLargestStall},
                                 {"overlap", found.overlap},
                                 {"gap", found.gap}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

std::vector<Task> tasks(const Options& asked) {
    std::vector<Task> all;
    for_each_scene(asked, kScenes, [&](std::uint64_t index) {
        WorldTraits traits = world_traits(asked.seed, index, asked.bodies.value_or(kMostBodies));
        if (!asked.has_joints) traits.joined_share = 0;
        add_runs(all, {.case_id = "random",
                       .scene = in_words(traits),
                       .solvers = solvers_of(asked, {Solver::automatic, Solver::soft, Solver::impulse,
                                                     Solver::event, Solver::rattle}),
                       .precisions = {asked.precision.value_or(traits.precision)},
                       .make = [traits] { return random_world(traits).scene; },
                       .run =
                           [=](const Scene&, Solver solver, Precision precision) {
                               return run(random_world(traits), traits, solver, precision, asked);
                           }});
    });
    return all;
}

}  // namespace

Case random_worlds() {
    return {.id = "random",
            .title = "random worlds of everything; overlaps in radii, gaps of joints in sizes of a body",
            .is_summed_up = true,
            .tasks = tasks};
}

}  // namespace carom::torture

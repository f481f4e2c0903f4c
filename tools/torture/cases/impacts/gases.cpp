#include <carom/generators.hpp>

#include <cmath>

#include "measure/text.hpp"
#include "torture/cases/impacts/parts.hpp"
#include "torture/crowd_scene.hpp"

namespace carom::torture {
namespace {

constexpr double kLargestDrift = 1e-3;       // of the energy of an elastic gas
constexpr double kLargestDifference = 0.03;  // from `event`, where chaos leaves averages alone

Scene gas_of(std::int64_t discs, double fill, double restitution, std::uint64_t seed) {
    const double half = 0.5 * std::sqrt(static_cast<double>(discs) * 3.141592653589793 * 0.25 / fill);
    Scene scene;
    scene.walls = Walls{.min = {-half, -half}, .max = {half, half}, .material = material_of(restitution)};
    Gas gas;
    gas.count = discs, gas.velocity_rms = 3, gas.seed = seed;
    gas.body.material = material_of(restitution);
    add_gas(scene, gas);
    return scene;
}

/// A segment that nothing can reach: what it may change is the solver.
Scene with_segment_outside(Scene scene) {
    Body segment;
    segment.type = BodyType::static_body;
    segment.shape = Segment{{-1, 0}, {1, 0}};
    segment.position = {0, 3 * scene.walls->max.y};
    scene.add(segment);
    return scene;
}

double outside_of(const Watch& watch, const Scene& scene) {
    double outside = 0;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        if (scene.bodies[i].type != BodyType::dynamic_body) continue;
        const Vec2 x = watch.state(i).position, low = scene.walls->min, high = scene.walls->max;
        outside += !(x.x > low.x && x.x < high.x && x.y > low.y && x.y < high.y);
    }
    return outside;
}

Outcome run_elastic(const Scene& scene, Solver solver, Precision precision, double time, double limit) {
    Watch watch(scene, solver, precision, limit);
    const double first = watch.kinetic_energy();
    watch.advance_to(time);
    Outcome outcome{.measures = {{"|E/E0 - 1|", std::abs(watch.kinetic_energy() / first - 1), kLargestDrift},
                                 {"quarantined", static_cast<double>(watch.quarantined()), 0},
                                 {"outside", outside_of(watch, scene), 0},
                                 {"overlap", watch.simulation().overlaps().max}},
                    .failure = watch.failure()};
    tell_times(outcome, watch);
    return outcome;
}

struct Cooling {
    double fill, restitution, time;  // -, -, s
};

constexpr std::uint64_t kStarts = 3;
constexpr std::int64_t kDiscs = 1000;

Outcome run_cooling(const Cooling& cooling, bool has_segment, Solver solver, Precision precision,
                    double limit) {
    double found = 0, exact = 0, first = 0, overlap = 0;
    Outcome outcome;
    for (std::uint64_t seed = 1; seed <= kStarts; ++seed) {
        const Scene scene = gas_of(kDiscs, cooling.fill, cooling.restitution, seed);
        Watch watch(has_segment ? with_segment_outside(scene) : scene, solver, precision, limit),
            reference(scene, Solver::event, Precision::double_, limit);
        first += watch.kinetic_energy();
        watch.advance_to(cooling.time), reference.advance_to(cooling.time);
        found += watch.kinetic_energy(), exact += reference.kinetic_energy();
        overlap = std::fmax(overlap, watch.simulation().overlaps().max);
        if (watch.gave_up()) outcome.failure = watch.failure();
        if (seed == kStarts) {
            outcome.measures = {{"difference", std::abs(found / exact - 1),
                                 cooling.restitution < 1 ? kLargestDifference : kLargestDrift},
                                {"E/E0", found / first},
                                {"exact", exact / first},
                                {"overlap", overlap}};
            tell_times(outcome, watch);
        }
    }
    return outcome;
}

constexpr std::int64_t kBalls = 200, kLooks = 50;
constexpr double kDropRestitution = 0.9, kDropTime = 5;  // -, s

/// Mean height at every look, over some starts [m]; frictionless, as `event` stays in heaps of rough discs.
std::vector<double> heights(Solver solver, Precision precision, double limit, std::string& failure) {
    std::vector<double> mean(kLooks, 0.0);
    for (std::uint64_t seed = 1; seed <= 2 * kStarts; ++seed) {
        const Scene scene = falling_crowd(kBalls, kDropRestitution, 0, seed);
        Watch watch(scene, solver, precision, limit);
        for (std::size_t i = 0; i < kLooks; ++i) {
            watch.advance_to(kDropTime * static_cast<double>(i + 1) / kLooks);
            mean[i] += watch.mean_height() / (2 * kStarts);
        }
        if (watch.gave_up()) failure = watch.failure();
    }
    return mean;
}

Outcome run_bounces(Solver solver, Precision precision, double limit) {
    Outcome outcome;
    const std::vector<double> exact = heights(Solver::event, Precision::double_, limit, outcome.failure);
    if (!outcome.failure.empty()) outcome.failure = "the reference " + outcome.failure;
    const std::vector<double> found = heights(solver, precision, limit, outcome.failure);
    double largest = 0;
    for (std::size_t i = 0; i < kLooks; ++i) largest = std::fmax(largest, std::abs(found[i] / exact[i] - 1));
    outcome.measures = {
        {"height", largest, kLargestDifference}, {"m at the end", found.back()}, {"exact", exact.back()}};
    return outcome;
}

}  // namespace

void add_gases(std::vector<Task>& all, const Options& asked) {
    const double limit = asked.limit;
    const std::vector<Precision> one{asked.precision.value_or(Precision::single_)};
    constexpr double kLong = 60;  // s
    add_impacts(
        all, asked, "200 elastic discs and a segment outside, 60 s", precisions_of(asked),
        [] { return with_segment_outside(gas_of(200, 0.39, 1, 1)); },
        [=](const Scene& scene, Solver solver, Precision precision) {
            return run_elastic(scene, solver, precision, kLong, limit);
        });
    for (const bool has_segment : {false, true})
        for (const Cooling cooling :
             {Cooling{.4, 1, 10}, {.6, 1, 10}, {.4, .99, 5}, {.6, .99, 5}, {.4, .95, 5}, {.6, .95, 5}})
            add_impacts(
                all, asked,
                measure::format("gas of 1,000%s, fill %g, e %g, %g s", has_segment ? " and a segment" : "",
                                cooling.fill, cooling.restitution, cooling.time),
                one,
                [=] {
                    const Scene scene = gas_of(kDiscs, cooling.fill, cooling.restitution, 1);
                    return has_segment ? with_segment_outside(scene) : scene;
                },
                [=](const Scene&, Solver solver, Precision precision) {
                    return run_cooling(cooling, has_segment, solver, precision, limit);
                });
    add_impacts(
        all, asked, "drop of 200, e .9", one, [=] { return falling_crowd(kBalls, kDropRestitution, 0); },
        [=](const Scene&, Solver solver, Precision precision) {
            return run_bounces(solver, precision, limit);
        });
}

}  // namespace carom::torture

#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <vector>

#include "measure/gas.hpp"
#include "measure/text.hpp"
#include "scenes/scenes.hpp"

// B6, B7 and B16 of docs/hard-cases.md, from their start to their end, beside a pile of as many
// bodies of nearly one size that has come to rest:
//     crowds/<case>/<float|double>
// `mean` and `worst` are times of a step over the mean step of that pile; for B6, rain and heap, over the
// mean step of the same scene without the large body. The worst is the median of five steps one after the
// other. docs/decisions/0018-crowds.md has the ratios.

namespace carom::bench {
namespace {

constexpr double kStep = measure::kStep;
constexpr int kSettling = 600, kMeasured = 200;  // steps of the pile
constexpr std::size_t kWindow = 5;

struct Crowd {
    Scene scene;
    int steps;
    int driven_steps = 0;
    double pull = 0;  // m/s², to the origin, on the first `pulled` bodies
    std::uint32_t pulled = 0;
    bool is_beside_pile = true;  // else beside itself without the first body
};

Crowd base(int steps, double gravity) {
    Crowd crowd{.scene = {}, .steps = steps};
    crowd.scene.accuracy.solver = Solver::soft;
    crowd.scene.gravity = {0, -gravity};
    return crowd;
}

Crowd pulled_lattice(std::int64_t side, double spacing, double jitter, double radius) {
    Crowd crowd = base(0, 0);
    Lattice lattice;
    lattice.count_x = lattice.count_y = side;
    const double corner = -0.5 * spacing * static_cast<double>(side - 1);
    lattice.origin = {corner, corner}, lattice.spacing = {spacing, spacing};
    lattice.jitter = jitter;
    lattice.body.shape = Disc{radius};
    add_lattice(crowd.scene, lattice);
    crowd.pulled = static_cast<std::uint32_t>(side * side);
    return crowd;
}

Crowd rush() {
    Crowd crowd = pulled_lattice(20, 2, 0.3, 0.5);
    crowd.steps = 420, crowd.driven_steps = 300, crowd.pull = 10;
    return crowd;
}

Crowd cell() {
    Crowd crowd = pulled_lattice(100, 0.12, 0.005, 0.05);
    crowd.scene.add({.shape = Disc{10}, .position = {20, 0}});
    crowd.steps = 720, crowd.driven_steps = 600, crowd.pull = 0.25;
    return crowd;
}

Crowd point() {
    Crowd crowd = base(120, 0);
    for (int i = 0; i < 1000; ++i)
        crowd.scene.add({.shape = Disc{0.5}, .position = {1, 2}, .material = {.friction = 0.3}});
    return crowd;
}

Crowd funnel() {
    Crowd crowd = base(480, 10);
    const Material rough{.friction = 0.8};
    for (const std::vector<Vec2>& side : {std::vector<Vec2>{{-8.55, 60}, {-8.55, 10}, {-0.55, 0}},
                                          std::vector<Vec2>{{0.55, 0}, {8.55, 10}, {8.55, 60}}})
        crowd.scene.add({.type = BodyType::static_body, .shape = Chain{side}, .material = rough});
    for (int i = 0; i < 300; ++i)
        crowd.scene.add({.shape = Disc{0.5 * (1.15 + 0.05 * (i % 4))},
                         .position = {-7.2 + 1.32 * (i % 12), 12 + 1.32 * (i / 12)},
                         .velocity = {0, -5},
                         .material = rough});
    return crowd;
}

/// Small discs that fall on and beside one a thousand times as large, `count` of them.
Crowd sizes(int count, double speed) {
    Crowd crowd = base(300, 10);
    crowd.is_beside_pile = false;
    constexpr double kSide = 12, kSmall = 0.01;
    const Material rough{.friction = 0.3};
    crowd.scene.walls = Walls{.min = {-kSide, 0}, .max = {kSide, 60}, .material = rough};
    crowd.scene.add({.shape = Disc{10}, .position = {0, 10}, .material = rough});
    const int columns = std::min(count, 1000);
    for (int i = 0; i < count; ++i)
        crowd.scene.add(
            {.shape = Disc{kSmall},
             .position = {-11.5 + 23.0 * (i % columns) / columns, 25 + 0.05 * (i % 11) + 0.6 * (i / columns)},
             .velocity = {0.5 * (i % 5 - 2), -speed},
             .material = rough});
    return crowd;
}

template <class World>
double time_step(World& world) {
    const auto start = std::chrono::steady_clock::now();
    world.step(kStep);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Mean time of a step of a pile of as many bodies, at rest [s].
template <class World>
double time_of_pile(std::size_t bodies) {
    Scene scene = make_scene("pile", static_cast<std::int64_t>(bodies)).scene;
    World world(scene, {.threads = 1});
    for (int i = 0; i < kSettling; ++i) world.step(kStep);
    double sum = 0;
    for (int i = 0; i < kMeasured; ++i) sum += time_step(world);
    return sum / kMeasured;
}

template <class World>
double time_without_first(const Crowd& crowd) {
    Scene scene = crowd.scene;
    scene.bodies.erase(scene.bodies.begin());
    World world(scene, {.threads = 1});
    double sum = 0;
    for (int i = 0; i < crowd.steps; ++i) sum += time_step(world);
    return sum / crowd.steps;
}

template <class World>
void pull(World& world, const Crowd& crowd) {
    for (std::uint32_t b = 0; b < crowd.pulled; ++b) {
        const BodyState s = world.state({b, 0});
        const double r = std::hypot(s.position.x, s.position.y);
        if (r == 0) continue;
        const double dv = -crowd.pull * kStep / r;
        world.set_velocity({b, 0}, {s.velocity.x + dv * s.position.x, s.velocity.y + dv * s.position.y});
    }
}

template <class World>
void run_crowd(benchmark::State& state, const Crowd& crowd) {
    try {
        double mean = 0, worst = 0, overlap = 0;
        for (auto _ : state) {
            World world(crowd.scene, {.threads = 1});
            std::vector<double> times;
            for (int i = 0; i < crowd.steps; ++i) {
                if (i < crowd.driven_steps) pull(world, crowd);
                times.push_back(time_step(world));
                if (i % 10 == 9) overlap = std::max(overlap, world.overlaps().max);
            }
            mean = worst = 0;
            for (const double t : times) mean += t / static_cast<double>(times.size());
            for (std::size_t i = 0; i + kWindow <= times.size(); ++i) {
                const auto first = times.begin() + static_cast<std::ptrdiff_t>(i);
                std::vector<double> window(first, first + kWindow);
                std::nth_element(window.begin(), window.begin() + kWindow / 2, window.end());
                worst = std::max(worst, window[kWindow / 2]);
            }
            state.SetIterationTime(mean);
        }
        const double uniform = crowd.is_beside_pile ? time_of_pile<World>(crowd.scene.bodies.size())
                                                    : time_without_first<World>(crowd);
        state.counters["uniform_ms"] = 1e3 * uniform;
        state.counters["mean"] = mean / uniform;
        state.counters["worst"] = worst / uniform;
        state.counters["overlap_max"] = overlap;
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
}

const bool kAdded = [] {
    const auto add = [](const char* name, const Crowd& crowd) {
        const auto add_for = [&](const char* precision, auto run) {
            benchmark::RegisterBenchmark(measure::joined("crowds/", name, "/", precision).c_str(),
                                         [run, crowd](benchmark::State& state) { run(state, crowd); })
                ->Unit(benchmark::kMillisecond)
                ->UseManualTime()
                ->Iterations(1);
        };
        add_for("float", &run_crowd<World>);
        add_for("double", &run_crowd<World64>);
    };
    add("funnel", funnel());
    add("rush", rush());
    add("cell", cell());
    add("point", point());
    add("rain", sizes(300, 20));
    add("heap", sizes(2'000, 1));
    return true;
}();

}  // namespace
}  // namespace carom::bench

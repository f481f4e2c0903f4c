#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <algorithm>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include "measure/gas.hpp"
#include "measure/text.hpp"

// B39 of docs/hard-cases.md: a pile at rest that is touched in every step.
//     touched/<what>/<restitution>/<float|double>/bodies:<n>        discs
//     touched-boxes/<what>/<restitution>/<float|double>/bodies:<n>  boxes
// `ratio` is the mean time of a step over that of the same pile untouched, both in processor time
// of the thread; `percent` of 1 touches 1 % of the bodies a step, 0 one body.

namespace carom::bench {
namespace {

constexpr double kStep = measure::kStep;
constexpr int kSettling = 2400, kMeasured = 100, kMeasuredOfMany = 20;  // steps

enum class Touch { nothing, remove, add, throw_up, teleport, drive };
enum class Kind { discs, boxes };

struct TouchedPile {
    Scene scene;
    double width;  // m
    Kind kind;
    BodyId segment;
};

/// A body as the others of a pile are, of a size from .8 to 1.2 m.
Shape shape_of(Kind kind, double size) {
    if (kind == Kind::discs) return Disc{size / 2};
    return Box{size, size};
}

/// Rough discs or boxes in a box open at the top, and a segment of 4 m just below the floor.
TouchedPile touched_pile(Kind kind, int count, double restitution) {
    TouchedPile pile{.scene = {}, .width = std::ceil(std::sqrt(count)), .kind = kind, .segment = {}};
    Scene& scene = pile.scene;
    const Material material{.friction = 0.5, .restitution = restitution};
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    scene.walls =
        Walls{.min = {0, 0}, .max = {pile.width, 20 * pile.width}, .top = false, .material = material};
    const int columns = static_cast<int>((pile.width - 0.7) / 1.25);
    for (int i = 0; i < count; ++i)
        scene.add({.shape = shape_of(kind, 0.8 + 0.4 * ((i * 37) % 101) / 101),
                   .position = {0.65 + 1.25 * (i % columns) + 0.04 * ((i * 53) % 97) / 97,
                                0.7 + 1.25 * (i / columns)},
                   .material = material});
    pile.segment = {static_cast<std::uint32_t>(count), 0};
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-2, 0}, {2, 0}},
               .position = {pile.width / 2, -0.2},
               .material = material});
    return pile;
}

double processor_time() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

/// @return s, mean time of a step with what touches the world in it
template <class World>
double time_of_step(const World& start, const TouchedPile& pile, Touch touch, int touched) {
    World world(start);
    const auto bodies = world.bodies();
    const double top = *std::max_element(bodies.position_y.begin(), bodies.position_y.end());
    const int a_line = static_cast<int>((pile.width - 2) / 1.3);
    int placed = 0;
    const auto free_place = [&] {
        const Vec2 place{1 + 1.3 * (placed % a_line), top + 2 + 1.3 * (placed / a_line)};
        ++placed;
        return place;
    };
    std::uint32_t next = 0;
    const auto pick = [&] {
        for (;;) {
            const auto present = world.bodies();
            const BodyId id = present.id[(next += 7919) % present.count];
            if (id != pile.segment) return id;
        }
    };
    const int steps = touched > 1 ? kMeasuredOfMany : kMeasured;
    const double start_time = processor_time();
    for (int i = 0; i < steps; ++i) {
        for (int k = 0; k < touched; ++k) {
            if (touch == Touch::remove) world.remove(pick());
            if (touch == Touch::add)
                world.add({.shape = shape_of(pile.kind, 1),
                           .position = free_place(),
                           .material = pile.scene.bodies[0].material});
            if (touch == Touch::throw_up) world.set_velocity(pick(), {0, 3});
            if (touch == Touch::teleport) world.set_position(pick(), free_place());
        }
        if (touch == Touch::drive) world.set_velocity(pile.segment, {0, 0.5 * std::cos(0.05 * i)});
        world.step(kStep);
    }
    return (processor_time() - start_time) / steps;
}

template <class World>
void run_touched(benchmark::State& state, Kind kind, Touch touch, double restitution, bool one_percent) {
    const auto count = static_cast<int>(state.range(0));
    const TouchedPile pile = touched_pile(kind, count, restitution);
    World start(pile.scene, {.threads = 1});
    for (int i = 0; i < kSettling; ++i) start.step(kStep);
    const int touched = one_percent ? count / 100 : 1;
    double time = 0;
    for (auto _ : state) {
        time = time_of_step(start, pile, touch, touched);
        state.SetIterationTime(time);
    }
    state.counters["ratio"] = time / time_of_step(start, pile, Touch::nothing, 0);
    state.counters["percent"] = one_percent ? 1 : 0;
}

const bool kAdded = [] {
    const auto add_of = [](Kind kind, const char* name, Touch touch, bool one_percent) {
        const char* of_kind = kind == Kind::discs ? "touched/" : "touched-boxes/";
        for (const double restitution : {0.0, 0.3}) {
            const auto add_for = [&](const char* precision, auto run) {
                benchmark::RegisterBenchmark(
                    measure::joined(of_kind, name, restitution > 0 ? "/0.3/" : "/0/", precision).c_str(),
                    [=](benchmark::State& state) { run(state, kind, touch, restitution, one_percent); })
                    ->ArgName("bodies")
                    ->Arg(1000)
                    ->Arg(10000)
                    ->Unit(benchmark::kMicrosecond)
                    ->UseManualTime()
                    ->Iterations(1);
            };
            add_for("float", &run_touched<World>);
            add_for("double", &run_touched<World64>);
        }
    };
    const auto add = [&](const char* name, Touch touch, bool one_percent) {
        for (const Kind kind : {Kind::discs, Kind::boxes}) add_of(kind, name, touch, one_percent);
    };
    add("remove", Touch::remove, false);
    add("add", Touch::add, false);
    add("throw", Touch::throw_up, false);
    add("teleport", Touch::teleport, false);
    add("drive", Touch::drive, false);
    add("remove-1%", Touch::remove, true);
    add("add-1%", Touch::add, true);
    add("throw-1%", Touch::throw_up, true);
    return true;
}();

}  // namespace
}  // namespace carom::bench

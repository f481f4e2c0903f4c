#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "measure/gas.hpp"
#include "measure/text.hpp"
#include "peers/body_measures.hpp"
#include "scenes/scenes.hpp"

// Whole scenes, what a step costs beside how well it keeps to the physics:
//     scenes/<scene>/<float|double>/<instruction set>/bodies:<n>/threads:<t>
// One item is a body and step. Discs are timed after a second or, where the scene changes as it goes, from
// its start on; other shapes are timed when the scene has settled.

namespace carom::bench {
namespace {

constexpr int kStepsBefore = 60;

template <class World>
std::vector<BodyState> states_of(const World& world) {
    const auto view = world.bodies();
    std::vector<BodyState> bodies(view.count);
    for (const BodyId id : view.id) bodies[id.index] = world.state(id);
    return bodies;
}

/// A world of the scene some steps later. It goes on from where a world of that scene once was, whatever its
/// instruction set and threads: these change no bit.
template <class World>
World world_after(const BenchScene& bench, const WorldOptions& options, int steps) {
    static std::map<std::pair<std::string, std::size_t>, std::vector<std::byte>> states;
    World world(bench.scene, options);
    std::vector<std::byte>& state = states[{bench.name, bench.scene.bodies.size()}];
    if (state.empty()) {
        for (int i = 0; i < steps; ++i) world.step(measure::kStep);
        state.resize(world.state_bytes());
        world.save_state(state);
    } else {
        world.restore_state(state);
    }
    return world;
}

template <class World>
void run_scene(benchmark::State& state, const std::string& name, const std::string& isa, bool settles) {
    try {
        const BenchScene bench = make_scene(name, state.range(0));
        const Scene& scene = bench.scene;
        WorldOptions options;
        options.isa = isa;
        options.threads = static_cast<int>(state.range(1));
        const bool restarts = bench.restart_steps > 0;
        const World start =
            world_after<World>(bench, options, restarts || settles ? bench.settle_steps : kStepsBefore);
        World world(start);
        std::int64_t steps_before = 0, impacts_before = 0;  // of runs that were over
        const Profile before = start.profile();
        const double energy_before = world.ledger().energy.total();
        for (auto _ : state) {
            world.step(measure::kStep);
            if (!restarts || world.profile().steps - before.steps < bench.restart_steps) continue;
            state.PauseTiming();
            steps_before += world.profile().steps - before.steps;
            impacts_before += world.profile().impacts - before.impacts;
            world = World(start);
            state.ResumeTiming();
        }
        Profile after = world.profile();
        after.steps += steps_before, after.impacts += impacts_before;
        const BodyMeasures measures = measure_bodies(scene, states_of(world));
        const auto body_steps = static_cast<double>(state.range(0) * (after.steps - before.steps));
        state.counters["impacts_per_body"] = static_cast<double>(after.impacts - before.impacts) / body_steps;
        state.counters["energy_error"] = world.ledger().energy.total() / energy_before - 1;
        state.counters["overlap_mean"] = measures.overlap_mean;
        state.counters["overlap_max"] = measures.overlap_max;
        state.counters["bytes_per_body"] =
            static_cast<double>(after.bytes) / static_cast<double>(state.range(0));
        state.SetItemsProcessed(state.iterations() * state.range(0));
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
}

void disc_sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"bodies", "threads"})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
    for (const std::int64_t bodies : {1'000, 10'000, 100'000, 1'000'000}) benchmark->Args({bodies, 1});
    for (const std::int64_t bodies : {10'000, 100'000}) benchmark->Args({bodies, 2});
}

template <std::int64_t kBodies>
void sizes_of(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"bodies", "threads"})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
    for (const std::int64_t threads : {1, 2}) benchmark->Args({kBodies, threads});
}

const bool kAdded = [] {
    const auto add_scene = [](const char* scene, bool settles,
                              void (*sizes)(benchmark::internal::Benchmark*)) {
        for (const std::string& isa : runnable_instruction_sets()) {
            const auto add = [&](const char* precision, auto run) {
                benchmark::RegisterBenchmark(
                    measure::joined("scenes/", scene, "/", precision, "/", isa).c_str(),
                    [run, scene, isa, settles](benchmark::State& state) { run(state, scene, isa, settles); })
                    ->Apply(sizes);
            };
            add("float", &run_scene<World>);
            add("double", &run_scene<World64>);
        }
    };
    for (const char* scene : {"gas", "rough-gas", "packed"}) add_scene(scene, false, &disc_sizes);
    for (const char* scene : {"pyramid", "pyramid-start"}) add_scene(scene, true, &sizes_of<5'050>);
    for (const char* scene : {"box-pile", "box-pile-start", "mixed-pile", "mixed-pile-start"})
        add_scene(scene, true, &sizes_of<10'000>);
    add_scene("smash", true, &sizes_of<5'001>);
    for (const char* scene : {"planks", "planks-start"}) add_scene(scene, true, &sizes_of<1'000>);
    add_scene("driven-drum", true, &sizes_of<2'026>);
    add_scene("spinner", true, &sizes_of<3'040>);
    return true;
}();

}  // namespace
}  // namespace carom::bench

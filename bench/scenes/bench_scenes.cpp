#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <string>

#include "measure/gas.hpp"
#include "measure/text.hpp"
#include "peers/body_measures.hpp"
#include "scenes/scenes.hpp"

// Whole scenes, what a step costs beside how well it keeps to the physics:
//     scenes/<scene>/<float|double>/<instruction set>/bodies:<n>/threads:<t>
// One item is a body and step.

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

template <class World>
void run_scene(benchmark::State& state, const std::string& name, const std::string& isa) {
    try {
        const BenchScene bench = make_scene(name, state.range(0));
        const Scene& scene = bench.scene;
        WorldOptions options;
        options.isa = isa;
        options.threads = static_cast<int>(state.range(1));
        const bool restarts = bench.restart_steps > 0;
        World start(scene, options);
        for (int i = 0; i < (restarts ? bench.settle_steps : kStepsBefore); ++i) start.step(measure::kStep);
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

void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"bodies", "threads"})
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime()
        ->MeasureProcessCPUTime();
    for (const std::int64_t bodies : {1'000, 10'000, 100'000, 1'000'000}) benchmark->Args({bodies, 1});
    for (const std::int64_t bodies : {10'000, 100'000}) benchmark->Args({bodies, 2});
}

const bool kAdded = [] {
    for (const char* scene : {"gas", "rough-gas", "packed"})
        for (const std::string& isa : runnable_instruction_sets()) {
            const auto add = [&](const char* precision, auto run) {
                benchmark::RegisterBenchmark(
                    measure::joined("scenes/", scene, "/", precision, "/", isa).c_str(),
                    [run, scene, isa](benchmark::State& state) { run(state, scene, isa); })
                    ->Apply(sizes);
            };
            add("float", &run_scene<World>);
            add("double", &run_scene<World64>);
        }
    return true;
}();

}  // namespace
}  // namespace carom::bench

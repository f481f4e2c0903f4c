#include <carom/carom.hpp>

#include <benchmark/benchmark.h>
#include <string>

#include "measure/clocks.hpp"
#include "measure/gas.hpp"
#include "measure/stage_times.hpp"
#include "measure/text.hpp"
#include "scenes/scenes.hpp"

// What each stage of a step costs: stages/<scene>/<precision>/bodies:<n>, with a counter a stage [s a step],
// and the share of the step that timing the stages takes.

namespace carom::bench {
namespace {

constexpr int kStepsBefore = 60;

template <class World>
void stages(benchmark::State& state, const std::string& scene) {
    try {
        WorldOptions options;
        options.threads = 1;
        World world(make_scene(scene, state.range(0)).scene, options);
        for (int i = 0; i < kStepsBefore; ++i) world.step(measure::kStep);
        const Profile before = world.profile();
        for (auto _ : state) world.step(measure::kStep);
        const Profile after = world.profile();
        const auto steps = static_cast<double>(after.steps - before.steps);
        double all = 0, readings = 0;
        for (const StageTime& stage : measure::stage_times_between(before, after)) {
            all += stage.seconds / steps;
            readings += static_cast<double>(stage.calls) / steps;
            state.counters[measure::joined("stage:", stage.name)] = stage.seconds / steps;
        }
        state.counters["measuring"] = (readings + 1) * measure::seconds_of_a_clock_reading() / all;
        state.counters["bytes_per_body"] =
            static_cast<double>(after.bytes) / static_cast<double>(state.range(0));
        state.SetItemsProcessed(state.iterations() * state.range(0));
    } catch (const Error& error) {
        state.SkipWithError(error.what());
    }
}

const bool kAdded = [] {
    for (const std::string& scene : {std::string("gas"), std::string("packed")}) {
        const auto add = [&scene](const char* precision, auto run) {
            benchmark::RegisterBenchmark(measure::joined("stages/", scene, "/", precision).c_str(),
                                         [run, scene](benchmark::State& state) { run(state, scene); })
                ->ArgName("bodies")
                ->RangeMultiplier(10)
                ->Range(1000, 1'000'000)
                ->Unit(benchmark::kMillisecond);
        };
        add("float", &stages<World>);
        add("double", &stages<World64>);
    }
    return true;
}();

}  // namespace
}  // namespace carom::bench

#include <carom/carom.hpp>

#include <benchmark/benchmark.h>

#include "measure/gas.hpp"
#include "scenes/scenes.hpp"

// Solver `event` on the elastic gas of docs/performance.md:
//     event/gas/bodies:<n>
// One item is a collision, walls included.

namespace carom::bench {
namespace {

void event_gas(benchmark::State& state) {
    Scene scene = make_scene("gas", state.range(0)).scene;
    scene.accuracy.solver = Solver::event;
    World64 world(scene, {.threads = 1});
    constexpr int kStepsBefore = 30;
    for (int i = 0; i < kStepsBefore; ++i) world.step(measure::kStep);
    const Profile before = world.profile();
    for (auto _ : state) world.step(measure::kStep);
    const Profile after = world.profile();
    const auto impacts = static_cast<double>(after.impacts - before.impacts);
    state.SetItemsProcessed(after.impacts - before.impacts);
    state.counters["pair_tests_per_impact"] =
        static_cast<double>(after.pair_tests - before.pair_tests) / impacts;
    state.counters["bytes_per_body"] = static_cast<double>(after.bytes) / static_cast<double>(state.range(0));
}
BENCHMARK(event_gas)
    ->Name("event/gas")
    ->ArgName("bodies")
    ->Arg(1'000)
    ->Arg(10'000)
    ->Arg(100'000)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace carom::bench

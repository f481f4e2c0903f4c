#include <carom/carom.hpp>
#include <carom/generators.hpp>
#include <carom/pairwise.hpp>

#include <benchmark/benchmark.h>
#include <cmath>
#include <string>

// The elastic gas of performance.md, whole steps: what it costs, what it resolves, how well it keeps its
// energy. One item is a body and step. Each run flies the gas a second before it is timed, so that its start
// on a lattice is forgotten and the first pairs, sorts and allocations are behind it.

namespace {

constexpr double kStep = 1.0 / 60;  // s
constexpr double kPacking = 0.40;   // area of the discs / area of the box
constexpr double kRadius = 0.5;     // m
constexpr double kSpeed = 3;        // m/s, root mean square
constexpr int kStepsBeforeTiming = 60;

carom::Scene gas_scene(std::int64_t count) {
    carom::Scene scene;
    const double side =
        std::sqrt(static_cast<double>(count) * 3.14159265358979323846 * kRadius * kRadius / kPacking);
    scene.walls.emplace();
    scene.walls->max = {side, side};
    scene.walls->material.restitution = 1;
    carom::Gas gas;
    gas.count = count;
    gas.radius = {kRadius, kRadius};
    gas.velocity_rms = kSpeed;
    gas.body.material.restitution = 1;
    carom::add_gas(scene, gas);
    return scene;
}

void finish(benchmark::State& state, std::int64_t bodies) {
    state.SetItemsProcessed(state.iterations() * bodies);
    state.counters["time/body"] =
        benchmark::Counter(static_cast<double>(bodies),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

template <class World>
void gas(benchmark::State& state, const std::string& isa) {
    carom::WorldOptions options;
    options.isa = isa;
    options.threads = static_cast<int>(state.range(1));
    World world(gas_scene(state.range(0)), options);
    for (int i = 0; i < kStepsBeforeTiming; ++i) world.step(kStep);
    const carom::Profile before = world.profile();
    const double energy_before = world.ledger().energy.total();
    for (auto _ : state) world.step(kStep);
    const carom::Profile after = world.profile();
    const auto per_body_step = [&](std::int64_t count) {
        return static_cast<double>(count) /
               static_cast<double>(state.range(0) * (after.steps - before.steps));
    };
    state.counters["impacts"] = per_body_step(after.impacts - before.impacts);
    state.counters["energy_error"] = world.ledger().energy.total() / energy_before - 1;
    state.counters["overlap_max"] = world.overlaps().max;
    state.counters["bytes/body"] = static_cast<double>(after.bytes) / static_cast<double>(state.range(0));
    finish(state, state.range(0));
}

/// The seed's loop over all pairs, for scale.
void gas_pairwise(benchmark::State& state) {
    const carom::Scene scene = gas_scene(state.range(0));
    carom::PairwiseScene description;
    description.walls.emplace();
    description.walls->max_x = scene.walls->max.x, description.walls->max_y = scene.walls->max.y;
    description.walls->restitution = 1;
    description.restitution = 1;
    for (const carom::Body& body : scene.bodies) {
        carom::PairwiseBody each;
        each.x = body.position.x, each.y = body.position.y;
        each.vx = body.velocity.x, each.vy = body.velocity.y;
        each.mass = 3.14159265358979323846 * kRadius * kRadius, each.radius = kRadius;
        description.bodies.push_back(each);
    }
    carom::Pairwise engine(description);
    for (auto _ : state) engine.step(kStep);
    finish(state, state.range(0));
}

void sizes(benchmark::internal::Benchmark* benchmark) {
    benchmark->ArgNames({"bodies", "threads"})->Unit(benchmark::kMillisecond)->UseRealTime();
    for (const std::int64_t bodies : {1'000, 10'000, 100'000, 1'000'000}) benchmark->Args({bodies, 1});
    benchmark->Args({100'000, 2});
}

const int kRegistered = [] {
    for (const std::string& isa : carom::runnable_instruction_sets()) {
        benchmark::RegisterBenchmark(("gas/float/" + isa).c_str(), gas<carom::World>, isa)->Apply(sizes);
        benchmark::RegisterBenchmark(("gas/double/" + isa).c_str(), gas<carom::World64>, isa)->Apply(sizes);
    }
    benchmark::RegisterBenchmark("gas/pairwise", gas_pairwise)
        ->ArgName("bodies")
        ->Arg(100)
        ->Arg(1'000)
        ->Arg(10'000)
        ->Unit(benchmark::kMillisecond);
    return 0;
}();

}  // namespace

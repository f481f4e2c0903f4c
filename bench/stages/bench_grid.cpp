#include "broadphase/grid/uniform_grid.hpp"
#include "isa/select_isa.hpp"
#include "kernels/gas_columns.hpp"

#include <benchmark/benchmark.h>
#include <string>

// The uniform grid as a whole, in the gas: sort, search, and queries one body at a time.

namespace {

using carom::Executor;
using carom::UniformGrid;
using carom::bench::GasColumns;
using carom::bench::make_gas;

void finish(benchmark::State& state, const carom::KernelTables& tables, std::size_t bodies) {
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(bodies));  // items = bodies
    state.counters["time/body"] =
        benchmark::Counter(static_cast<double>(bodies),
                           benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
    state.SetLabel(std::string(tables.of<float>().isa));
}

void grid_build(benchmark::State& state, const carom::KernelTables* tables) {
    const auto bodies = static_cast<std::size_t>(state.range(0));
    const GasColumns<float> gas = make_gas<float>(bodies);
    const Executor executor(1);
    UniformGrid<float> grid;
    for (auto _ : state) {
        grid.build(gas.input(), tables->of<float>(), executor);
        benchmark::ClobberMemory();
    }
    finish(state, *tables, bodies);
}

void grid_candidates(benchmark::State& state, const carom::KernelTables* tables) {
    const auto bodies = static_cast<std::size_t>(state.range(0));
    const GasColumns<float> gas = make_gas<float>(bodies);
    const Executor executor(1);
    UniformGrid<float> grid;
    grid.build(gas.input(), tables->of<float>(), executor);
    for (auto _ : state) {
        benchmark::DoNotOptimize(grid.find_candidates(executor).count);
        benchmark::ClobberMemory();
    }
    state.counters["pairs/body"] = static_cast<double>(grid.candidates().count) / static_cast<double>(bodies);
    finish(state, *tables, bodies);
}

/// Items are queries, one a body, in the order of rows.
void grid_find_near(benchmark::State& state, const carom::KernelTables* tables) {
    const auto bodies = static_cast<std::size_t>(state.range(0));
    const GasColumns<float> gas = make_gas<float>(bodies);
    UniformGrid<float> grid;
    grid.build(gas.input(), tables->of<float>(), Executor(1));
    carom::Column<std::int32_t> rows;
    for (auto _ : state)
        for (std::size_t row = 0; row < bodies; ++row)
            benchmark::DoNotOptimize(grid.find_near(gas.x[row], gas.y[row], gas.reach[row], rows));
    finish(state, *tables, bodies);
}

void add_for_every_isa(const char* name, void (*run)(benchmark::State&, const carom::KernelTables*)) {
    for (const carom::KernelTables* tables : carom::runnable_kernel_tables())
        benchmark::RegisterBenchmark((std::string(name) + "/" + std::string(tables->of<float>().isa)).c_str(),
                                     run, tables)
            ->ArgName("bodies")
            ->RangeMultiplier(10)
            ->Range(1000, 1'000'000);
}

const bool kAdded = [] {
    add_for_every_isa("grid_build", &grid_build);
    add_for_every_isa("grid_candidates", &grid_candidates);
    add_for_every_isa("grid_find_near", &grid_find_near);
    return true;
}();

}  // namespace

#include "broadphase/grid/cell_numbering.hpp"
#include "broadphase/grid/sorted_level.hpp"
#include "kernels/gas_columns.hpp"
#include "kernels/kernel_benchmark.hpp"
#include "parallel/executor.hpp"

#include <numbers>
#include <random>

namespace carom::bench {
namespace {

constexpr double kCellsLooked = 9;     // 3 x 3 around a body
constexpr double kPairsCounted = 4.5;  // cells of them, where each pair is looked at once

template <class Real>
FindBounds<Real> bounds_of(const GasColumns<Real>& gas, const KernelTable<Real>& table) {
    FindBounds<Real> bounds{gas.x.data(), gas.y.data(), gas.reach.data(), gas.x.size(), 0, 0, 0, 0, 0, 0};
    table.find_bounds(bounds);
    return bounds;
}

/// A gas sorted into the cells of one level.
template <class Real>
struct SortedGas {
    SortedGas(std::size_t bodies, double reach, const KernelTable<Real>& table)
        : gas(make_gas<Real>(bodies, reach)) {
        const LevelInput<Real> input{gas.x.data(), gas.y.data(),          gas.reach.data(),        nullptr,
                                     bodies,       bounds_of(gas, table), static_cast<Real>(reach)};
        level.sort(input, table, Executor(1));
    }
    double bodies_per_cell() const {
        return static_cast<double>(level.view().places) / static_cast<double>(level.view().cells);
    }
    GasColumns<Real> gas;
    SortedLevel<Real> level;
};

template <class Real>
void find_bounds(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    const GasColumns<Real> gas = make_gas<Real>(items);
    FindBounds<Real> arguments = bounds_of(gas, table);
    const measure::Work work{.bytes = 3 * sizeof(Real), .operations = 6};
    time_kernel(state, {work, items, 3 * sizeof(Real) * items}, [&] { table.find_bounds(arguments); });
}

template <class Real>
void find_cells(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    const GasColumns<Real> gas = make_gas<Real>(items);
    Column<std::int32_t> cell(items);
    const FindCells<Real> arguments{
        gas.x.data(), gas.y.data(), items,
        number_cells(bounds_of(gas, table), gas.x.data(), gas.y.data(), items, 2 * kGasReach), cell.data()};
    // scaled, two clamps and floor along each axis, cell from both
    const measure::Work work{.bytes = 2 * sizeof(Real) + sizeof(std::int32_t), .operations = 12};
    time_kernel(state, {work, items, static_cast<std::size_t>(work.bytes) * items},
                [&] { table.find_cells(arguments); });
}

/// Items are bodies; hits are pairs a body, in per cent of what the gas of docs/performance.md has.
template <class Real>
void find_candidates(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    // The pairs a body has grow with the area in reach, beyond the contact of two discs.
    const double reach = 0.5 + (kGasReach - 0.5) * static_cast<double>(state.range(1)) / 100;
    const SortedGas<Real> sorted(items, reach, table);
    Column<std::int32_t> a(8 * items + 4096), b(8 * items + 4096);
    FindCandidates<Real> arguments{&sorted.level.view(), 0, items, a.data(), b.data(), a.size(), 0};
    table.find_candidates(arguments);
    const double pairs = static_cast<double>(arguments.count) / static_cast<double>(items);
    // x, y, reach, row and cell of a body, begins of its cells, its pairs; six operations a comparison
    const measure::Work work{.bytes = 3 * sizeof(Real) + 8 + 4 / sorted.bodies_per_cell() + 8 * pairs,
                             .operations = 8 * kPairsCounted * sorted.bodies_per_cell()};
    time_kernel(state, {work, items, static_cast<std::size_t>(work.bytes) * items, pairs}, [&] {
        arguments.count = 0;
        benchmark::DoNotOptimize(table.find_candidates(arguments));
    });
}

/// Items are queries, one a body, in the order of rows.
template <class Real>
void find_near(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    const SortedGas<Real> sorted(items, kGasReach, table);
    Column<std::int32_t> found(1024);
    std::size_t count = 0;
    const auto query = [&] {
        for (std::size_t row = 0; row < items; ++row)
            count += table.find_near(
                sorted.level.view(),
                {sorted.gas.x[row], sorted.gas.y[row], sorted.gas.reach[row], found.data(), found.size()});
        benchmark::DoNotOptimize(count);
    };
    query();
    const double looked = kCellsLooked * sorted.bodies_per_cell();
    const measure::Work work{.bytes = 3 * sizeof(Real) + 24 + looked * (3 * sizeof(Real) + 4),
                             .operations = 8 * looked};
    const double hits = static_cast<double>(count) / static_cast<double>(items);
    time_kernel(state, {work, items, (6 * sizeof(Real) + 12) * items, hits}, query);
}

/// Items are bodies that were deflected and ask what they can hit now, one after the other in the order of
/// rows, as the solver does. The hit rate sets the speeds: 10 are the 3 m/s of the gas.
template <class Real>
void find_impacts_near(benchmark::State& state, const KernelTable<Real>& table, bool uniform_radius) {
    constexpr double kSubstep = 1.0 / 60;  // s
    const auto items = static_cast<std::size_t>(state.range(0));
    const SortedGas<Real> sorted(items, kGasReach, table);
    Column<Real> motion(4 * items), radius(items);
    std::mt19937 random(17);
    std::normal_distribution<double> speed(
        0, 3 / std::numbers::sqrt2 * static_cast<double>(state.range(1)) / 10);
    for (std::size_t row = 0; row < items; ++row) {
        Real* record = motion.data() + 4 * row;
        record[0] = sorted.gas.x[row], record[1] = sorted.gas.y[row];
        record[2] = static_cast<Real>(speed(random)), record[3] = static_cast<Real>(speed(random));
        radius[row] = Real(0.5);
    }
    Column<std::int32_t> found(1024);
    const auto kernel = uniform_radius ? table.find_impacts_near_uniform_radius : table.find_impacts_near;
    std::size_t count = 0;
    const auto query = [&] {
        for (std::size_t row = 0; row < items; ++row)
            count += kernel(sorted.level.view(),
                            {sorted.gas.x[row], sorted.gas.y[row], sorted.gas.reach[row], motion.data(),
                             static_cast<std::int32_t>(row), uniform_radius ? nullptr : radius.data(),
                             Real(0.5), 0, static_cast<Real>(kSubstep), 0, found.data(), found.size()});
        benchmark::DoNotOptimize(count);
    };
    query();
    // begins of three rows of cells; of each body in them its row and its record
    const double looked = kCellsLooked * sorted.bodies_per_cell();
    const double record = (uniform_radius ? 4 : 5) * sizeof(Real);
    const measure::Work work{.bytes = 24 + looked * (4 + record),
                             .operations = (uniform_radius ? 28 : 30) * looked};
    const double hits = static_cast<double>(count) / static_cast<double>(items);
    time_kernel(state, {work, items, static_cast<std::size_t>(record + 12) * items, hits}, query);
}

const bool kAdded = [] {
    add_kernel("find_bounds", false, [](auto& state, const auto& table) { find_bounds(state, table); });
    add_kernel("find_cells", false, [](auto& state, const auto& table) { find_cells(state, table); });
    add_kernel("find_candidates", true,
               [](auto& state, const auto& table) { find_candidates(state, table); });
    add_kernel("find_near", false, [](auto& state, const auto& table) { find_near(state, table); });
    for (const bool uniform : {false, true})
        add_kernel(uniform ? "find_impacts_near_uniform_radius" : "find_impacts_near", true,
                   [uniform](auto& state, const auto& table) { find_impacts_near(state, table, uniform); });
    return true;
}();

}  // namespace
}  // namespace carom::bench

#pragma once

#include "isa/select_isa.hpp"

#include <benchmark/benchmark.h>
#include <cstddef>
#include <string>
#include <vector>

#include "measure/ceilings.hpp"
#include "measure/text.hpp"

// What the benchmarks of kernels share. A benchmark's name says all it depends on:
//     kernels/<kernel>/<instruction set>/<float|double>/items:<n>[/hits:<per cent>]

namespace carom::bench {

/// Of a kernel: how much it does for an item, how much memory it goes through, and what share of the tested
/// items it found.
struct KernelWork {
    measure::Work work;
    std::size_t items = 0;
    std::size_t working_set = 0;  ///< bytes
    double hits = 0;              ///< found / items; may exceed 1 (pairs a body)
};

/// Times run() over and over and notes what makes a roofline of it.
template <class Run>
void time_kernel(benchmark::State& state, const KernelWork& kernel, const Run& run) {
    for (auto _ : state) {
        run();
        benchmark::ClobberMemory();
    }
    state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kernel.items));
    state.SetBytesProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) *
                                                      static_cast<double>(kernel.items) * kernel.work.bytes));
    state.counters["operations_per_item"] = kernel.work.operations;
    state.counters["bytes_per_item"] = kernel.work.bytes;
    state.counters["working_set"] = static_cast<double>(kernel.working_set);
    state.counters["hits"] = kernel.hits;
}

/// Sizes of the first and second cache, the third, and of memory.
inline constexpr std::int64_t kItemsInL1 = 256;
inline constexpr std::int64_t kItemsInL2 = 4'096;
inline constexpr std::int64_t kItemsInL3 = 131'072;
inline constexpr std::int64_t kItemsInMemory = 1'048'576;

inline std::vector<std::int64_t> kernel_sizes() {
    return {kItemsInL1, kItemsInL2, kItemsInL3, kItemsInMemory};
}
inline std::vector<std::int64_t> hit_rates() {
    return {1, 10, 50, 100};  // per cent
}

/// Registers run<Real>(state, kernel table) for every instruction set and size.
/// @param hits  whether it takes hit rates too, as state.range(1) in per cent
template <class Real, class Run>
void add_kernel_of(const std::string& kernel, bool hits, const Run& run) {
    const char* const precision = sizeof(Real) == sizeof(float) ? "float" : "double";
    for (const KernelTables* tables : runnable_kernel_tables()) {
        const KernelTable<Real>* table = &tables->of<Real>();
        const std::string name = measure::joined("kernels/", kernel, "/", table->isa, "/", precision);
        benchmark::internal::Benchmark* added = benchmark::RegisterBenchmark(
            name.c_str(), [run, table](benchmark::State& state) { run(state, *table); });
        if (hits)
            added->ArgNames({"items", "hits"})->ArgsProduct({kernel_sizes(), hit_rates()});
        else
            added->ArgNames({"items"})->ArgsProduct({kernel_sizes()});
    }
}

/// The same in both precisions; `run` is generic over the table.
template <class Run>
void add_kernel(const std::string& kernel, bool hits, const Run& run) {
    add_kernel_of<float>(kernel, hits, run);
    add_kernel_of<double>(kernel, hits, run);
}

}  // namespace carom::bench

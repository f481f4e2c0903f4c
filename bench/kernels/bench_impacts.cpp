#include "kernels/kernel_benchmark.hpp"
#include "state/columns/column.hpp"

#include <numeric>
#include <random>

namespace carom::bench {
namespace {

constexpr double kSubstep = 1.0 / 60;  // s
constexpr double kGap = 0.05;          // m between the discs of a pair

/// Pairs of discs close to each other, each body in two pairs, neighbours in memory as after sorting by
/// cell. Of a chosen share, at random places, the bodies meet within the substep.
template <class Real>
struct PairColumns {
    PairColumns(std::size_t pairs, double share_that_meets)
        : motion(4 * (pairs + 1 + kRowPadding)),
          radius(pairs + 1 + kRowPadding),
          a(pairs),
          b(pairs),
          found(pairs + kRowPadding) {
        std::mt19937 random(13);
        std::uniform_real_distribution<double> unit(0, 1);
        double speed = 0;  // m/s; of the next body so that it meets the one before, or does not
        for (std::size_t body = 0; body < pairs + 1; ++body) {
            Real* record = motion.data() + 4 * body;
            record[0] = static_cast<Real>((1 + kGap) * static_cast<double>(body % 1024));
            record[1] = 0;
            record[2] = static_cast<Real>(speed);
            record[3] = 0;
            // One period of 1,024 bodies does not touch the next; within it speeds fall or rise.
            const double change = unit(random) < share_that_meets ? -2 * kGap / kSubstep : 1;
            speed = body % 1024 == 1023 ? 0 : speed + change;
        }
        for (Real& each : radius) each = Real(0.5);
        std::iota(a.begin(), a.end(), 0);
        std::iota(b.begin(), b.end(), 1);
    }

    Column<Real> motion, radius;
    Column<std::int32_t> a, b, found;
};

template <class Real>
void find_impacts(benchmark::State& state, const KernelTable<Real>& table, bool uniform_radius) {
    const auto items = static_cast<std::size_t>(state.range(0));
    PairColumns<Real> columns(items, static_cast<double>(state.range(1)) / 100);
    const FindImpacts<Real> arguments{columns.motion.data(),
                                      columns.a.data(),
                                      columns.b.data(),
                                      uniform_radius ? nullptr : columns.radius.data(),
                                      Real(0.5),
                                      static_cast<Real>(kSubstep),
                                      0,
                                      0,
                                      columns.found.data()};
    const auto kernel = uniform_radius ? table.find_impacts_uniform_radius : table.find_impacts;
    const double hits = static_cast<double>(kernel(arguments, 0, items)) / static_cast<double>(items);
    // two rows, one new record of four a pair (each is in two), what is listed
    const double record = (uniform_radius ? 4 : 5) * sizeof(Real);
    const measure::Work work{.bytes = 8 + record + 4 * hits, .operations = uniform_radius ? 29.0 : 31.0};
    time_kernel(state, {work, items, static_cast<std::size_t>(8 + record) * items, hits},
                [&] { benchmark::DoNotOptimize(kernel(arguments, 0, items)); });
}

const bool kAdded = [] {
    for (const bool uniform : {false, true}) {
        const std::string suffix = uniform ? "_uniform_radius" : "";
        add_kernel("find_impacts" + suffix, true,
                   [uniform](auto& state, const auto& table) { find_impacts(state, table, uniform); });
    }
    return true;
}();

}  // namespace
}  // namespace carom::bench

#include "effects/flight.hpp"
#include "kernels/kernel_benchmark.hpp"
#include "state/columns/column.hpp"

#include <limits>
#include <random>

namespace carom::bench {
namespace {

constexpr double kSubstep = 1.0 / 60;  // s
constexpr double kSpacing = 1.4;       // m

/// Bodies in free flight; a chosen share of them near the left wall, at random rows.
template <class Real>
struct FlightColumns {
    FlightColumns(std::size_t bodies, double share_at_wall)
        : x(bodies),
          y(bodies),
          vx(bodies),
          vy(bodies),
          reach(bodies),
          radius(bodies),
          motion(4 * bodies),
          wall_rows(bodies + kRowPadding),
          displaced_rows(bodies + kRowPadding),
          lost_rows(bodies + kRowPadding) {
        std::mt19937 random(11);
        std::uniform_real_distribution<double> unit(0, 1), speed(-3, 3);
        for (std::size_t i = 0; i < bodies; ++i) {
            x[i] = static_cast<Real>(unit(random) < share_at_wall ? 0.5 : 10 + kSpacing * unit(random));
            y[i] = static_cast<Real>(kSpacing * static_cast<double>(i));
            vx[i] = static_cast<Real>(speed(random)), vy[i] = static_cast<Real>(speed(random));
            reach[i] = Real(1), radius[i] = Real(0.5);
        }
    }

    BeginFlight<Real> begin_arguments(bool uniform_radius) {
        constexpr Real kInfinity = std::numeric_limits<Real>::infinity();
        const auto s = static_cast<Real>(kSubstep);
        return {x.data(),
                y.data(),
                vx.data(),
                vy.data(),
                x.data(),
                y.data(),
                reach.data(),
                uniform_radius ? nullptr : radius.data(),
                Real(0.5),
                s,
                0,
                0,
                0,
                0,
                0,
                0,
                Real(1.001),
                0,
                -kInfinity,
                kInfinity,
                kInfinity,
                Real(1e8),
                Real(1e7),
                motion.data(),
                wall_rows.data(),
                displaced_rows.data(),
                lost_rows.data()};
    }

    Column<Real> x, y, vx, vy, reach, radius, motion;
    Column<std::int32_t> wall_rows, displaced_rows, lost_rows;
};

template <class Real>
void begin_flight(benchmark::State& state, const KernelTable<Real>& table, bool uniform_radius) {
    const auto items = static_cast<std::size_t>(state.range(0));
    FlightColumns<Real> columns(items, static_cast<double>(state.range(1)) / 100);
    const BeginFlight<Real> arguments = columns.begin_arguments(uniform_radius);
    const auto kernel = uniform_radius ? table.begin_flight_uniform_radius : table.begin_flight;
    const double hits = static_cast<double>(kernel(arguments, 0, items).wall) / static_cast<double>(items);
    // positions, velocities, reach; here positions are where pairs were found too; a record of four is
    // written, and the rows that are listed
    const double columns_read = uniform_radius ? 5 : 6;
    const measure::Work work{.bytes = (columns_read + 4) * sizeof(Real) + 4 * hits, .operations = 43};
    time_kernel(state,
                {work, items, static_cast<std::size_t>((columns_read + 4) * sizeof(Real)) * items, hits},
                [&] { benchmark::DoNotOptimize(kernel(arguments, 0, items)); });
}

template <class Real>
void end_flight(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    FlightColumns<Real> columns(items, 0);
    table.begin_flight_uniform_radius(columns.begin_arguments(true), 0, items);
    const EndFlight<Real> arguments{
        columns.motion.data(), static_cast<Real>(kSubstep), 0, 0, 0, 0, 0, columns.x.data(), columns.y.data(),
        columns.vx.data(),     columns.vy.data(),           0, 0};
    const measure::Work work{.bytes = 8 * sizeof(Real), .operations = 16};
    time_kernel(state, {work, items, 8 * sizeof(Real) * items},
                [&] { table.end_flight(arguments, 0, items); });
}

template <class Real>
void advance_rotation(benchmark::State& state, const KernelTable<Real>& table) {
    const auto items = static_cast<std::size_t>(state.range(0));
    Column<Real> angle(items), spin(items);
    for (Real& each : spin) each = Real(1);
    const AdvanceRotation<Real> arguments{angle.data(), spin.data(), static_cast<Real>(kSubstep), Real(1)};
    const measure::Work work{.bytes = 4 * sizeof(Real), .operations = 3};
    time_kernel(state, {work, items, 2 * sizeof(Real) * items},
                [&] { table.advance_rotation(arguments, 0, items); });
}

const bool kAdded = [] {
    add_kernel("begin_flight", true,
               [](auto& state, const auto& table) { begin_flight(state, table, false); });
    add_kernel("begin_flight_uniform_radius", true,
               [](auto& state, const auto& table) { begin_flight(state, table, true); });
    add_kernel("end_flight", false, [](auto& state, const auto& table) { end_flight(state, table); });
    add_kernel("advance_rotation", false,
               [](auto& state, const auto& table) { advance_rotation(state, table); });
    return true;
}();

}  // namespace
}  // namespace carom::bench

#pragma once

#include "broadphase/grid/uniform_grid.hpp"
#include "state/columns/column.hpp"

#include <cstddef>
#include <vector>

namespace carom::bench {

inline constexpr double kGasPacking = 0.40;
inline constexpr double kGasReach = 0.675;  // m: radius .5 and slack .175

/// Hard discs of radius .5 in equilibrium by Monte Carlo, rows in the order that a grid gave them some steps
/// ago: the gas of docs/performance.md at one moment. Made once for each size.
struct GasPositions {
    std::vector<double> x, y;  // m
};
const GasPositions& gas_positions(std::size_t bodies);

template <class Real>
struct GasColumns {
    Column<Real> x, y, reach;
    GridInput<Real> input() const { return {x.size(), x.data(), y.data(), reach.data(), nullptr}; }
};

template <class Real>
GasColumns<Real> make_gas(std::size_t bodies, double reach = kGasReach) {
    const GasPositions& positions = gas_positions(bodies);
    GasColumns<Real> gas{Column<Real>(bodies), Column<Real>(bodies), Column<Real>(bodies)};
    for (std::size_t i = 0; i < bodies; ++i) {
        gas.x[i] = static_cast<Real>(positions.x[i]);
        gas.y[i] = static_cast<Real>(positions.y[i]);
        gas.reach[i] = static_cast<Real>(reach);
    }
    return gas;
}

}  // namespace carom::bench

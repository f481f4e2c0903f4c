#include "kernels/gas_columns.hpp"

#include "isa/select_isa.hpp"

#include <cmath>
#include <map>
#include <numbers>
#include <random>

namespace carom::bench {
namespace {

/// Hard discs of radius .5, moved at random. Cells are so small that each holds one centre at most.
class GasSampler {
  public:
    explicit GasSampler(std::size_t bodies) : x(bodies), y(bodies) {
        const auto side = static_cast<std::size_t>(std::ceil(std::sqrt(static_cast<double>(bodies))));
        const double spacing = std::sqrt(std::numbers::pi / 4 / kGasPacking);
        extent_ = spacing * static_cast<double>(side);
        columns_ = static_cast<std::size_t>(extent_ / kCell) + 5;
        body_in_.assign(columns_ * columns_, -1);
        for (std::size_t i = 0; i < bodies; ++i) {
            x[i] = spacing * (static_cast<double>(i % side) + .5);
            y[i] = spacing * (static_cast<double>(i / side) + .5);
            body_in_[cell(x[i], y[i])] = static_cast<std::int32_t>(i);
        }
    }

    /// Each body tries to move once by up to `reach` along each axis.
    void sweep(double reach) {
        std::uniform_real_distribution<double> shift(-reach, reach);
        for (std::size_t i = 0; i < x.size(); ++i) {
            const double new_x = x[i] + shift(random_), new_y = y[i] + shift(random_);
            if (new_x < 0 || new_x >= extent_ || new_y < 0 || new_y >= extent_ || !is_free(i, new_x, new_y))
                continue;
            body_in_[cell(x[i], y[i])] = -1;
            body_in_[cell(new_x, new_y)] = static_cast<std::int32_t>(i);
            x[i] = new_x;
            y[i] = new_y;
        }
    }

    std::vector<double> x, y;  // m

  private:
    static constexpr double kCell = 0.7;  // m, below 1 / sqrt(2)

    std::size_t cell(double at_x, double at_y) const {
        return (static_cast<std::size_t>(at_y / kCell) + 2) * columns_ +
               static_cast<std::size_t>(at_x / kCell) + 2;
    }
    bool is_free(std::size_t body, double at_x, double at_y) const {
        const std::size_t centre = cell(at_x, at_y);
        for (std::size_t line = centre - 2 * columns_; line <= centre + 2 * columns_; line += columns_)
            for (std::size_t c = line - 2; c <= line + 2; ++c) {
                if (body_in_[c] < 0 || body_in_[c] == static_cast<std::int32_t>(body)) continue;
                const auto other = static_cast<std::size_t>(body_in_[c]);
                if (std::hypot(x[other] - at_x, y[other] - at_y) < 1) return false;
            }
        return true;
    }

    double extent_;
    std::size_t columns_;
    std::vector<std::int32_t> body_in_;
    std::mt19937 random_{7};
};

GasPositions sample(std::size_t bodies) {
    GasSampler sampler(bodies);
    for (int sweep = 0; sweep < 30; ++sweep) sampler.sweep(.4);
    GasColumns<float> gas{Column<float>(bodies), Column<float>(bodies), Column<float>(bodies)};
    for (std::size_t i = 0; i < bodies; ++i) {
        gas.x[i] = static_cast<float>(sampler.x[i]);
        gas.y[i] = static_cast<float>(sampler.y[i]);
        gas.reach[i] = static_cast<float>(kGasReach);
    }
    UniformGrid<float> grid;
    grid.build(gas.input(), select_kernels("auto").of<float>(), Executor(1));
    for (int sweep = 0; sweep < 3; ++sweep) sampler.sweep(.3);
    GasPositions positions;
    for (const std::int32_t row : grid.order()) {
        positions.x.push_back(sampler.x[static_cast<std::size_t>(row)]);
        positions.y.push_back(sampler.y[static_cast<std::size_t>(row)]);
    }
    return positions;
}

}  // namespace

const GasPositions& gas_positions(std::size_t bodies) {
    static std::map<std::size_t, GasPositions> made;
    const auto found = made.find(bodies);
    return found != made.end() ? found->second : made.emplace(bodies, sample(bodies)).first->second;
}

}  // namespace carom::bench

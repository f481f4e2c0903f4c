#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace carom {

/// Impulses that are not free of each other, each within bounds: of contacts whose bodies others move, too.
/// Solved by Gauss-Seidel sweeps, each of O(count²).
class CoupledImpulses {
  public:
    std::vector<double> given;  ///< N s, by row
    std::vector<double> lack;   ///< m/s, what each row lacks with what is given

    void reset(std::size_t count) {
        given.assign(count, 0), lack.assign(count, 0), masses_.assign(count * count, 0);
    }
    std::size_t count() const { return given.size(); }
    /// 1/kg, what an impulse of row k gives to row i.
    double& inverse_mass(std::size_t i, std::size_t k) { return masses_[i * count() + k]; }
    double inverse_mass(std::size_t i, std::size_t k) const { return masses_[i * count() + k]; }

    /// Finds impulses with which no row lacks anything, as far as bounds allow.
    /// @param bound  bound(i, wanted): the impulse that row i may have; rows without an inverse mass keep
    /// theirs
    /// @param least  m/s: changes by less are none
    template <class Bound>
    void solve(const Bound& bound, double least) {
        constexpr int kMostSweeps = 100;
        for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
            double largest = 0;
            for (std::size_t i = 0; i < count(); ++i) {
                const double mass = inverse_mass(i, i);
                if (!(mass > 0)) continue;
                const double change = bound(i, given[i] + lack[i] / mass) - given[i];
                if (change == 0) continue;
                given[i] += change;
                for (std::size_t k = 0; k < count(); ++k) lack[k] -= inverse_mass(k, i) * change;
                largest = std::fmax(largest, mass * std::fabs(change));
            }
            if (!(largest > least)) return;
        }
    }

    std::size_t bytes() const {
        return (given.capacity() + lack.capacity() + masses_.capacity()) * sizeof(double);
    }

  private:
    std::vector<double> masses_;  // [count][count]
};

}  // namespace carom

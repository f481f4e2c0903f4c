#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom {

/// Impulses that are not free of each other, each within bounds: of contacts whose bodies others move, too.
/// Solved by Gauss-Seidel sweeps, each of O(count²); motors among them by elimination, of O(motors count²).
class CoupledImpulses {
  public:
    /// Between what the impulse of a motor is [N s].
    struct Ends {
        double low, high;
    };

    std::vector<double> given;  ///< N s, by row
    std::vector<double> lack;   ///< m/s, what each row lacks with what is given
    /// 1/kg, by row: one that has no more than that as its inverse mass keeps its impulse.
    std::vector<double> least_inverse_mass;

    void reset(std::size_t count) {
        given.assign(count, 0), lack.assign(count, 0), masses_.assign(count * count, 0);
        least_inverse_mass.assign(count, 0);
    }
    std::size_t count() const { return given.size(); }
    /// 1/kg, what an impulse of row k gives to row i.
    double& inverse_mass(std::size_t i, std::size_t k) { return masses_[k * count() + i]; }
    double inverse_mass(std::size_t i, std::size_t k) const { return masses_[k * count() + i]; }

    /// Finds impulses with which no row lacks anything, as far as bounds allow.
    /// @param bound  bound(i, wanted): the impulse that row i may have
    /// @param least  m/s: changes by less are none
    template <class Bound>
    void solve(const Bound& bound, double least) {
        sweep(count(), masses_, lack, bound, least);
    }

    /// The same where the last rows are those of motors. What a motor holds may weigh hundreds of times what
    /// it drives, and sweeps would hand on of that what would stop the lighter: so motors that are between
    /// their ends are eliminated, the others push with what they have, and those that come to an end or leave
    /// it change sides.
    /// @param motors  of the last rows, in their order  @param bound  asked for the rows before them
    template <class Bound>
    void solve(std::span<const Ends> motors, const Bound& bound, double least) {
        constexpr int kMostRounds = 8;
        if (motors.empty()) return solve(bound, least);
        const std::size_t first = count() - motors.size();
        const auto clamped = [&](std::size_t i, double wanted) {
            return std::clamp(wanted, motors[i - first].low, motors[i - first].high);
        };
        is_free_.resize(motors.size());
        for (std::size_t m = 0; m < motors.size(); ++m) {
            const std::size_t i = first + m;
            const bool is_at_end = lack[i] > 0 ? given[i] >= motors[m].high : given[i] <= motors[m].low;
            is_free_[m] = motors[m].low < motors[m].high && !(is_at_end && lack[i] != 0);
        }
        bool any = true;
        for (int round = 0; any && round < kMostRounds; ++round) {
            eliminate(first);
            before_ = given;
            sweep(first, reduced_, reduced_lack_, bound, least);
            any = false;
            for (std::size_t i = first; i < count(); ++i) {
                if (!is_free_[i - first]) continue;
                const double mass = reduced_[i * count() + i];
                if (!(mass > least_inverse_mass[i])) continue;
                const double wanted = given[i] + reduced_lack_[i] / mass;
                given[i] = clamped(i, wanted);
                if (given[i] != wanted) is_free_[i - first] = 0, any = true;
            }
            for (std::size_t k = 0; k < count(); ++k)
                if (given[k] != before_[k]) take(&masses_[k * count()], given[k] - before_[k], lack.data());
            for (std::size_t i = first; i < count(); ++i) {
                const auto [low, high] = motors[i - first];
                if (is_free_[i - first] || !(low < high)) continue;
                const bool leaves = given[i] < high ? lack[i] > least : lack[i] < -least;
                if (leaves) is_free_[i - first] = 1, any = true;
            }
        }
        if (any)
            solve([&](std::size_t i,
                      double wanted) { return i < first ? bound(i, wanted) : clamped(i, wanted); },
                  least);
    }

    std::size_t bytes() const {
        return (given.capacity() + lack.capacity() + masses_.capacity() + reduced_.capacity() +
                reduced_lack_.capacity() + before_.capacity() + shares_.capacity() +
                least_inverse_mass.capacity()) *
                   sizeof(double) +
               is_free_.capacity();
    }

  private:
    /// Sweeps over the first `rows` rows; what all rows lack with that goes to `lacks`.
    template <class Bound>
    void sweep(std::size_t rows, const std::vector<double>& masses, std::vector<double>& lacks,
               const Bound& bound, double least) {
        constexpr int kMostSweeps = 100;
        for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
            double largest = 0;
            for (std::size_t i = 0; i < rows; ++i) {
                const double mass = masses[i * count() + i];
                if (!(mass > least_inverse_mass[i])) continue;
                const double change = bound(i, given[i] + lacks[i] / mass) - given[i];
                if (change == 0) continue;
                given[i] += change;
                take(&masses[i * count()], change, lacks.data());
                largest = std::fmax(largest, mass * std::fabs(change));
            }
            if (!(largest > least)) return;
        }
    }

    /// The masses and lacks of all rows while motors that are free, from row `first` on, hold.
    void eliminate(std::size_t first) {
        const std::size_t n = count();
        reduced_ = masses_, reduced_lack_ = lack;
        for (std::size_t f = first; f < n; ++f) {
            const double own = reduced_[f * n + f];
            if (!is_free_[f - first] || !(own > least_inverse_mass[f])) continue;
            shares_.assign(&reduced_[f * n], &reduced_[f * n] + n);
            for (double& share : shares_) share /= own;
            shares_[f] = 0;
            for (std::size_t k = 0; k < n; ++k)
                if (const double of_motor = reduced_[k * n + f]; of_motor != 0)
                    take(shares_.data(), of_motor, &reduced_[k * n]);
            take(shares_.data(), reduced_lack_[f], reduced_lack_.data());
        }
    }

    /// Takes `times` a column from another.
    void take(const double* column, double times, double* from) const {
        for (std::size_t i = 0; i < count(); ++i) from[i] -= column[i] * times;
    }

    // What one impulse gives to all rows lies side by side, as sweeps take it: rows there would be as many
    // lines of the cache.
    std::vector<double> masses_;                                    // [count of impulses][count of rows]
    std::vector<double> reduced_, reduced_lack_, before_, shares_;  // where motors are eliminated
    std::vector<std::uint8_t> is_free_;                             // by motor
};

}  // namespace carom

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
        is_free_.clear();
        settle(count(), bound, least);
    }

    /// The same where the last rows are those of motors. What a motor holds may weigh hundreds of times what
    /// it drives, and sweeps would hand on of that what would stop the lighter: so motors that are between
    /// their ends are eliminated, the others push with what they have, and those that come to an end or leave
    /// it change sides.
    /// @param motors  of the last rows, in their order  @param bound  asked for the rows before them
    template <class Bound>
    void solve(std::span<const Ends> motors, const Bound& bound, double least) {
        constexpr int kMostRounds = 8;  // motors that change sides in turns are left as they are
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
            settle(first, bound, least);
            any = false;
            for (std::size_t i = first; i < count(); ++i) {
                if (!is_free_[i - first]) continue;
                const double wanted = given[i];
                given[i] = clamped(i, wanted);
                if (given[i] == wanted) continue;
                take(&masses_[i * count()], given[i] - wanted, count(), lack.data());
                is_free_[i - first] = 0, any = true;
            }
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
                reduced_lack_.capacity() + old_.capacity() + shares_.capacity() +
                least_inverse_mass.capacity()) *
                   sizeof(double) +
               (working_.capacity() + columns_.capacity()) * sizeof(std::size_t) + works_.capacity() +
               is_free_.capacity();
    }

  private:
    /// What a row may change by as things are.
    template <class Bound>
    double change_of(std::size_t i, const Bound& bound) const {
        const double mass = inverse_mass(i, i);
        return mass > least_inverse_mass[i] ? bound(i, given[i] + lack[i] / mass) - given[i] : 0;
    }

    /// Adds to working_ the rows before `rows` that others have not, and that want to change.
    /// @return the most that one of them changes its own velocity by [m/s]
    template <class Bound>
    double join_those_that_want(std::size_t rows, const Bound& bound) {
        double largest = 0;
        const std::size_t old = working_.size();
        for (std::size_t i = 0; i < rows; ++i) {
            if (works_[i]) continue;
            const double change = change_of(i, bound);
            if (change == 0) continue;
            working_.push_back(i), works_[i] = 1;
            largest = std::fmax(largest, inverse_mass(i, i) * std::fabs(change));
        }
        std::inplace_merge(working_.begin(), working_.begin() + static_cast<std::ptrdiff_t>(old),
                           working_.end());
        return largest;
    }

    /// Sweeps over the first `rows` rows, while motors that are free hold. Of the contacts that there may be
    /// few press, so sweeps go over those that do, and all others are looked at now and then.
    template <class Bound>
    void settle(std::size_t rows, const Bound& bound, double least) {
        constexpr int kMostSweeps = 100, kBetweenLooks = 25;  // docs/decisions/0082-what-presses-of-many.md
        working_.clear(), works_.assign(rows, 0);
        for (std::size_t i = 0; i < rows; ++i)
            if (given[i] != 0 && inverse_mass(i, i) > least_inverse_mass[i])
                working_.push_back(i), works_[i] = 1;
        join_those_that_want(rows, bound);
        for (int sweeps = 0;;) {
            const bool is_done =
                sweep_working(bound, least, std::min(sweeps + kBetweenLooks, kMostSweeps), sweeps);
            const bool settled = !(join_those_that_want(rows, bound) > least);
            if ((is_done && settled) || sweeps == kMostSweeps) return;
        }
    }

    /// Sweeps over working_, and what motors that are free give with that.
    /// @param sweeps  so far  @param most  of them
    /// @return whether the last one changed next to nothing
    template <class Bound>
    bool sweep_working(const Bound& bound, double least, int most, int& sweeps) {
        const std::size_t rows = working_.size();
        gather();
        eliminate(rows);
        bool is_done = false;
        for (; !is_done && sweeps < most; ++sweeps) {
            double largest = 0;
            for (std::size_t i = 0; i < rows; ++i) {
                const double mass = reduced_[i * columns_.size() + i];
                const std::size_t row = columns_[i];
                if (!(mass > least_inverse_mass[row])) continue;
                const double change = bound(row, given[row] + reduced_lack_[i] / mass) - given[row];
                if (change == 0) continue;
                given[row] += change;
                take(&reduced_[i * columns_.size()], change, columns_.size(), reduced_lack_.data());
                largest = std::fmax(largest, mass * std::fabs(change));
            }
            is_done = !(largest > least);
        }
        for (std::size_t i = rows; i < columns_.size(); ++i) {
            const double mass = reduced_[i * columns_.size() + i];
            if (mass > least_inverse_mass[columns_[i]]) given[columns_[i]] += reduced_lack_[i] / mass;
        }
        for (std::size_t i = 0; i < columns_.size(); ++i)
            if (const double change = given[columns_[i]] - old_[i]; change != 0)
                take(&masses_[columns_[i] * count()], change, count(), lack.data());
        return is_done;
    }

    /// The masses and lacks of the working rows and, behind them, of motors that are free.
    void gather() {
        columns_.assign(working_.begin(), working_.end());
        for (std::size_t m = 0; m < is_free_.size(); ++m)
            if (is_free_[m]) columns_.push_back(count() - is_free_.size() + m);
        const std::size_t n = columns_.size();
        reduced_.resize(n * n), reduced_lack_.resize(n), old_.resize(n);
        for (std::size_t k = 0; k < n; ++k) {
            reduced_lack_[k] = lack[columns_[k]], old_[k] = given[columns_[k]];
            const double* column = &masses_[columns_[k] * count()];
            for (std::size_t i = 0; i < n; ++i) reduced_[k * n + i] = column[columns_[i]];
        }
    }

    /// Makes them those while these motors hold, from row `first` of columns_ on.
    void eliminate(std::size_t first) {
        const std::size_t n = columns_.size();
        for (std::size_t f = first; f < n; ++f) {
            const double own = reduced_[f * n + f];
            if (!(own > least_inverse_mass[columns_[f]])) continue;
            shares_.assign(&reduced_[f * n], &reduced_[f * n] + n);
            for (double& share : shares_) share /= own;
            shares_[f] = 0;
            for (std::size_t k = 0; k < n; ++k)
                if (const double of_motor = reduced_[k * n + f]; of_motor != 0)
                    take(shares_.data(), of_motor, n, &reduced_[k * n]);
            take(shares_.data(), reduced_lack_[f], n, reduced_lack_.data());
        }
    }

    /// Takes `times` a column of n rows from another.
    static void take(const double* column, double times, std::size_t n, double* from) {
        for (std::size_t i = 0; i < n; ++i) from[i] -= column[i] * times;
    }

    // What one impulse gives to all rows lies side by side, as sweeps take it: rows there would be as many
    // lines of the cache.
    std::vector<double> masses_;         // [count of impulses][count of rows]
    std::vector<std::size_t> working_;   // rows that press or want to, ascending
    std::vector<std::uint8_t> works_;    // by row: whether it is one of these
    std::vector<std::uint8_t> is_free_;  // by motor
    std::vector<std::size_t> columns_;   // the working rows, and behind them motors that are free
    // The system of these columns: masses [1/kg], lacks [m/s], impulses before the sweeps [N s], and what a
    // motor takes of each (scratch).
    std::vector<double> reduced_, reduced_lack_, old_, shares_;
};

}  // namespace carom

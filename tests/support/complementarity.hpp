#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace carom::test {

/// 0 <= x ⟂ A x + b >= 0 for a symmetric positive definite A, by trying every set of unknowns that may differ
/// from zero, in long double. Of 12 unknowns at most: time grows as 2^n n³.
class Complementarity {
  public:
    explicit Complementarity(std::size_t unknowns)
        : count_(unknowns), matrix_(unknowns * unknowns, 0), constant_(unknowns, 0) {}

    long double& a(std::size_t row, std::size_t column) { return matrix_[row * count_ + column]; }
    long double& b(std::size_t row) { return constant_[row]; }

    /// Empty if there is no solution to within `allowed` (in units of b for A x + b, of x for x).
    std::vector<long double> solve(long double allowed = 1e-12L) const {
        for (unsigned active = 0; active < 1u << count_; ++active) {
            const std::vector<long double> x = solve_active(active);
            if (!x.empty() && is_solution(x, allowed)) return x;
        }
        return {};
    }

  private:
    bool is_solution(const std::vector<long double>& x, long double allowed) const {
        for (std::size_t row = 0; row < count_; ++row) {
            long double residual = constant_[row];
            for (std::size_t column = 0; column < count_; ++column)
                residual += matrix_[row * count_ + column] * x[column];
            if (x[row] < -allowed || residual < -allowed) return false;
        }
        return true;
    }

    /// Gauss-Jordan elimination of the active rows and columns; empty if they are singular.
    std::vector<long double> solve_active(unsigned active) const {
        std::vector<std::size_t> index;
        for (std::size_t i = 0; i < count_; ++i)
            if ((active >> i & 1u) != 0) index.push_back(i);
        const std::size_t n = index.size();
        std::vector<long double> rows(n * (n + 1));
        for (std::size_t i = 0; i < n; ++i) {
            for (std::size_t j = 0; j < n; ++j) rows[i * (n + 1) + j] = matrix_[index[i] * count_ + index[j]];
            rows[i * (n + 1) + n] = -constant_[index[i]];
        }
        for (std::size_t k = 0; k < n; ++k) {
            const long double pivot = rows[k * (n + 1) + k];
            if (!(pivot > 1e-14L * matrix_[index[k] * count_ + index[k]])) return {};
            for (std::size_t j = k; j <= n; ++j) rows[k * (n + 1) + j] /= pivot;
            for (std::size_t i = 0; i < n; ++i) {
                if (i == k) continue;
                const long double factor = rows[i * (n + 1) + k];
                for (std::size_t j = k; j <= n; ++j) rows[i * (n + 1) + j] -= factor * rows[k * (n + 1) + j];
            }
        }
        std::vector<long double> x(count_, 0);
        for (std::size_t i = 0; i < n; ++i) x[index[i]] = rows[i * (n + 1) + n];
        return x;
    }

    std::size_t count_;
    std::vector<long double> matrix_, constant_;
};

}  // namespace carom::test

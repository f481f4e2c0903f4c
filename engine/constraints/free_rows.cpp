#include "constraints/free_rows.hpp"

namespace carom {

void FreeRows::factor(std::span<const double> matrix, std::size_t stride, std::span<const std::size_t> rows,
                      std::span<const double> alone, double softness) {
    const std::size_t m = rows.size();
    rows_.assign(rows.begin(), rows.end());
    columns_.resize(m * m), across_.resize(m * m), pivot_.resize(m), by_softness_.resize(m);
    are_independent_ = true;
    for (std::size_t c = 0; c < m; ++c) {
        double* column = &columns_[c * m];
        for (std::size_t r = c; r < m; ++r) column[r] = matrix[rows[r] * stride + rows[c]];
        column[c] += softness * alone[rows[c]];
        double by_softness = softness * alone[rows[c]];
        for (std::size_t k = 0; k < c; ++k) {
            const double* before = &columns_[k * m];
            const double l = before[c], f = l * pivot_[k];
            by_softness += l * l * by_softness_[k];
            for (std::size_t r = c; r < m; ++r) column[r] -= before[r] * f;
        }
        const double pivot = column[c];
        pivot_[c] = pivot, by_softness_[c] = by_softness;
        are_independent_ = are_independent_ && by_softness < kLittle * pivot;
        for (std::size_t r = c + 1; r < m; ++r) across_[r * m + c] = column[r] /= pivot;
    }
}

void FreeRows::solve(std::span<double> x, std::size_t sides) const {
    const std::size_t m = rows_.size();
    if (sides == 1) return solve_one(x.data());
    const auto take = [&](std::size_t row, double times, std::size_t from) {
        const double* value = &x[row * sides];
        double* to = &x[from * sides];
        for (std::size_t s = 0; s < sides; ++s) to[s] -= times * value[s];
    };
    for (std::size_t k = 0; k < m; ++k)
        for (std::size_t i = k + 1; i < m; ++i) take(k, columns_[k * m + i], i);
    for (std::size_t i = 0; i < m; ++i)
        for (std::size_t s = 0; s < sides; ++s) x[i * sides + s] /= pivot_[i];
    for (std::size_t k = m; k-- > 0;)
        for (std::size_t i = 0; i < k; ++i) take(k, across_[k * m + i], i);
}

void FreeRows::solve_one(double* x) const {
    const std::size_t m = rows_.size();
    for (std::size_t k = 0; k < m; ++k) {
        const double* column = &columns_[k * m];
        const double value = x[k];
        for (std::size_t i = k + 1; i < m; ++i) x[i] -= column[i] * value;
    }
    for (std::size_t i = 0; i < m; ++i) x[i] /= pivot_[i];
    for (std::size_t k = m; k-- > 0;) {
        const double* row = &across_[k * m];
        const double value = x[k];
        for (std::size_t i = 0; i < k; ++i) x[i] -= row[i] * value;
    }
}

std::size_t FreeRows::bytes() const {
    return rows_.capacity() * sizeof(std::size_t) +
           (columns_.capacity() + across_.capacity() + pivot_.capacity() + by_softness_.capacity()) *
               sizeof(double);
}

}  // namespace carom

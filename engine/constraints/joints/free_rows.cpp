#include "constraints/joints/free_rows.hpp"

#include <algorithm>

namespace carom {

void FreeRows::factor(std::span<const double> matrix, std::size_t stride, std::span<const std::size_t> rows,
                      std::span<const double> alone, double softness, bool is_same_matrix) {
    const std::size_t m = rows.size();
    // A row of L is made of those before it: where lists begin alike, so do factors.
    const std::size_t kept =
        is_same_matrix ? static_cast<std::size_t>(std::ranges::mismatch(rows, rows_).in1 - rows.begin()) : 0;
    rows_.assign(rows.begin(), rows.end()), stride_ = stride;
    columns_.resize(stride * stride), across_.resize(stride * stride);
    pivot_.resize(m), by_softness_.resize(m);
    are_independent_ = true;
    for (std::size_t c = 0; c < m; ++c) {
        double* column = &columns_[c * stride];
        const std::size_t first = std::max(c, kept);
        for (std::size_t r = first; r < m; ++r) column[r] = matrix[rows[r] * stride + rows[c]];
        double by_softness = softness * alone[rows[c]];
        if (first == c) column[c] += by_softness;
        for (std::size_t k = 0; k < c; ++k) {
            const double* before = &columns_[k * stride];
            const double l = before[c], f = l * pivot_[k];
            by_softness += l * l * by_softness_[k];
            for (std::size_t r = first; r < m; ++r) column[r] -= before[r] * f;
        }
        const double pivot = column[c];
        pivot_[c] = pivot, by_softness_[c] = by_softness;
        are_independent_ = are_independent_ && by_softness < kLittle * pivot;
        for (std::size_t r = std::max(c + 1, kept); r < m; ++r) across_[r * stride + c] = column[r] /= pivot;
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
        for (std::size_t i = k + 1; i < m; ++i) take(k, columns_[k * stride_ + i], i);
    for (std::size_t i = 0; i < m; ++i)
        for (std::size_t s = 0; s < sides; ++s) x[i * sides + s] /= pivot_[i];
    for (std::size_t k = m; k-- > 0;)
        for (std::size_t i = 0; i < k; ++i) take(k, across_[k * stride_ + i], i);
}

void FreeRows::solve_one(double* x) const {
    const std::size_t m = rows_.size();
    for (std::size_t k = 0; k < m; ++k) {
        const double* column = &columns_[k * stride_];
        const double value = x[k];
        for (std::size_t i = k + 1; i < m; ++i) x[i] -= column[i] * value;
    }
    for (std::size_t i = 0; i < m; ++i) x[i] /= pivot_[i];
    for (std::size_t k = m; k-- > 0;) {
        const double* row = &across_[k * stride_];
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

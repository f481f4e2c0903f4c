#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace carom {

/// L D L^T of some rows of a dense symmetric matrix, and what it solves: the rows of a system of joints that
/// are no part of its tree and at no end (joint_system.hpp).
///
/// Columns of L lie side by side, so that all loops run along them, by as many lanes as there are.
class FreeRows {
  public:
    /// Softness has little part in a pivot below this share of it.
    static constexpr double kLittle = 1. / 3;

    /// Factors the matrix with some softness on its diagonal. Cost: count³ / 6; if the list of rows begins as
    /// the one before did, count² / 2 for each row behind that.
    /// @param matrix  [stride][stride]  @param rows  of it, ascending
    /// @param alone  by row of the matrix: of what softness is a share
    /// @param is_same_matrix  whether all but the rows are those of the call before
    void factor(std::span<const double> matrix, std::size_t stride, std::span<const std::size_t> rows,
                std::span<const double> alone, double softness, bool is_same_matrix = false);
    /// Whether softness has little part in all pivots.
    bool are_independent() const { return are_independent_; }
    std::span<const std::size_t> rows() const { return rows_; }
    /// The solutions of the factored rows take the place of their right sides. Cost: count² a side.
    /// @param x  [count][sides]
    void solve(std::span<double> x, std::size_t sides) const;
    std::size_t bytes() const;

  private:
    void solve_one(double* x) const;

    std::vector<std::size_t> rows_;
    std::size_t stride_ = 0;
    std::vector<double> columns_;  // of L, [stride][stride], below the diagonal
    std::vector<double> across_;   // its rows, likewise
    std::vector<double> pivot_;    // D
    std::vector<double> by_softness_;
    bool are_independent_ = true;
};

}  // namespace carom

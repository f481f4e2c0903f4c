#include "broadphase/cell_numbering.hpp"

#include <algorithm>
#include <cmath>

namespace carom {
namespace {

// Up to so many cells a body the grid covers the occupied box as it is; docs/decisions/0001-broadphase.md.
constexpr double kBoxCellsPerBody = 4;
constexpr double kFewCells = 64;  // never worth folding
// Else the plane is folded onto so many cells a body.
constexpr double kFoldedCellsPerBody = 2;
constexpr double kMostFoldedCells = (1 << 26) - 1;  // keeps the numbering's products exact in double
// Rows of the folded plane start that fraction of all cells apart. With the golden section no short vector
// leads from a cell to one of the same number, so that a cluster of any shape spreads over the cells.
constexpr double kGoldenSection = 0.38196601125010515;

/// Whole cell coordinate of the lower and upper end; one cell if there is no number between them.
struct Extent {
    double low, high;
};
Extent extent_of(double low, double high, double inverse_size) {
    if (!(low <= high)) return {0, 0};
    const auto coordinate = [&](double position) {
        return std::floor(std::clamp(position * inverse_size, -kFarthestCell, kFarthestCell));
    };
    return {coordinate(low), coordinate(high)};
}

}  // namespace

template <class Real>
CellNumbering number_cells(const FindBounds<Real>& bounds, double size, std::size_t bodies) {
    CellNumbering n{};
    n.inverse_size = 1 / size;
    const Extent u =
        extent_of(static_cast<double>(bounds.min_x), static_cast<double>(bounds.max_x), n.inverse_size);
    const Extent v =
        extent_of(static_cast<double>(bounds.min_y), static_cast<double>(bounds.max_y), n.inverse_size);
    n.low_u = u.low, n.high_u = u.high;
    n.low_v = v.low, n.high_v = v.high;

    const double columns = u.high - u.low + 1, lines = v.high - v.low + 1;
    const auto count = static_cast<double>(bodies);
    n.wraps = columns * lines > kBoxCellsPerBody * count + kFewCells;
    if (n.wraps) {
        const double wanted = std::max(kFoldedCellsPerBody * count, kFewCells) + 1;
        n.cells = std::min(2 * std::floor(wanted / 2) + 1,
                           kMostFoldedCells);  // odd: no cell grid divides it evenly
        n.width = std::floor(n.cells * kGoldenSection);
    } else {
        n.width = std::max(columns, 3.0);
        n.cells = std::max(n.width * lines, 2 * n.width + 3);
    }
    n.inverse_cells = 1 / n.cells;
    return n;
}

template CellNumbering number_cells(const FindBounds<float>&, double, std::size_t);
template CellNumbering number_cells(const FindBounds<double>&, double, std::size_t);

}  // namespace carom

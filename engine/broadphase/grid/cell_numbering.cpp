#include "broadphase/grid/cell_numbering.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace carom {
namespace {

// Up to so many cells a body the grid covers the occupied box as it is; docs/decisions/0001-broadphase.md.
constexpr double kBoxCellsPerBody = 4;
constexpr double kFewCells = 64;  // never worth folding
// A plane with too many cells for that is folded onto this many cells a body.
constexpr double kFoldedCellsPerBody = 2;
constexpr double kMostFoldedCells = (1 << 26) - 1;  // keeps the numbering's products exact in double
// Rows of the folded plane start this fraction of all cells apart if the bodies form more than one cluster.
// With the golden section no short vector leads from a cell to one of the same number: bodies spread over
// the cells.
constexpr double kGoldenSection = 0.38196601125010515;

constexpr std::size_t kSamples = 256;  // bodies that tell how far most of them are spread

/// Whole cell coordinates of the lower and the upper end of the bodies; both are one cell's if no number
/// lies between.
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

/// Cells across most of the bodies along one axis, strays left out: from the middle 80 % of a sample.
template <class Real>
double usual_width(const Real* position, std::size_t count, double inverse_size) {
    std::array<double, kSamples> sample;
    const std::size_t samples = std::min(count, kSamples);
    for (std::size_t i = 0; i < samples; ++i) {
        const double cell = static_cast<double>(position[i * count / samples]) * inverse_size;
        sample[i] = std::isnan(cell) ? 0 : std::clamp(cell, -kFarthestCell, kFarthestCell);
    }
    const auto end = sample.begin() + static_cast<std::ptrdiff_t>(samples);
    std::sort(sample.begin(), end);
    const double middle = sample[samples - 1 - samples / 10] - sample[samples / 10];
    return middle / 0.8 * 1.05 + 4;
}

/// How many numbers rows of the folded plane are apart. Rows of one large cluster follow each other as they
/// would without folding, so that strays cost nothing; else they are spread.
template <class Real>
double folded_width(const Real* x, const Real* y, std::size_t count, double inverse_size, double cells) {
    const double columns = std::ceil(usual_width(x, count, inverse_size));
    const double lines = std::ceil(usual_width(y, count, inverse_size));
    if (columns * lines <= cells && 2 * columns + 3 <= cells) return columns;
    return std::floor(cells * kGoldenSection);
}

}  // namespace

template <class Real>
CellNumbering number_cells(const FindBounds<Real>& bounds, const Real* x, const Real* y, std::size_t count,
                           double size) {
    CellNumbering n{};
    n.inverse_size = 1 / size;
    const Extent u =
        extent_of(static_cast<double>(bounds.min_x), static_cast<double>(bounds.max_x), n.inverse_size);
    const Extent v =
        extent_of(static_cast<double>(bounds.min_y), static_cast<double>(bounds.max_y), n.inverse_size);
    n.low_u = u.low, n.high_u = u.high;
    n.low_v = v.low, n.high_v = v.high;

    const double columns = u.high - u.low + 1, lines = v.high - v.low + 1;
    const auto bodies = static_cast<double>(count);
    n.wraps = columns * lines > kBoxCellsPerBody * bodies + kFewCells;
    if (n.wraps) {
        const double wanted = std::max(kFoldedCellsPerBody * bodies, kFewCells);
        n.cells =
            std::min(2 * std::floor(wanted / 2) + 1, kMostFoldedCells);  // odd: even spacings share it out
        n.width = folded_width(x, y, count, n.inverse_size, n.cells);
    } else {
        n.width = std::max(columns, 3.0);
        n.cells = std::max(n.width * lines, 2 * n.width + 3);
    }
    n.inverse_cells = 1 / n.cells;
    return n;
}

template CellNumbering number_cells(const FindBounds<float>&, const float*, const float*, std::size_t,
                                    double);
template CellNumbering number_cells(const FindBounds<double>&, const double*, const double*, std::size_t,
                                    double);

}  // namespace carom

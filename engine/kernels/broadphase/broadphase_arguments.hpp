#pragma once

#include <cstddef>
#include <cstdint>

namespace carom {

/// Smallest and largest of each column over rows [0, rows); NaN is passed over. Any row count.
template <class Real>
struct FindBounds {
    const Real* x;      // m, [padded(rows)], 64-byte aligned
    const Real* y;      // m
    const Real* reach;  // m
    std::size_t rows;
    Real min_x, max_x, min_y, max_y, min_reach, max_reach;  // out; min > max if there is no number
};

/// Cell coordinates end there; far positions share the last cell, which costs time and misses nothing. It
/// keeps a coordinate exact to 2^-22 of a cell: cells are larger than twice the largest reach by more than
/// that.
inline constexpr double kFarthestCell = 1 << 30;

/// How a level of the grid numbers its cells. Cell (u, v), counted from the origin cell, has the number
/// (u + width * v) mod cells: a helix around a torus, so that the plane has no edge. While the occupied box
/// has at most `cells` cells, nothing wraps and the numbers are those of a plain row-major grid. Cells (u-1
/// .. u+1, v) are consecutive; the three rows of a 3 x 3 block never share a number, because width >= 3 and
/// cells >= 2 * width + 3.
struct CellNumbering {
    double inverse_size;  // 1/m
    double low_u,
        low_v;  // the occupied box, whole, within +-kFarthestCell; (low_u, low_v) is the origin cell
    double high_u, high_v;  // positions outside are taken to its border, which keeps neighbours neighbours
    double width;           // cells from one row to the next
    double cells;           // numbers in use, whole and < 2^26, so that products stay exact
    double inverse_cells;
    bool wraps;  // the occupied box is larger than `cells`
};

/// cell_out[i] = number of the cell that (x[i], y[i]) lies in; of the box's first one for NaN. Writes whole
/// batches: columns and cell_out are padded.
template <class Real>
struct FindCells {
    const Real* x;  // m, [rows]
    const Real* y;
    std::size_t rows;
    CellNumbering numbering;
    std::int32_t* cell_out;  // [rows]
};

/// So many places after the last body are read; their x is infinite, so they are near nothing.
inline constexpr std::size_t kPlacesBeyond = 64;

/// Bodies sorted by cell.
template <class Real>
struct SortedBodies {
    const Real* x;                   // m, [places]
    const Real* y;                   // m
    const Real* reach;               // m
    const std::int32_t* row;         // where the body is in the columns
    const std::int32_t* cell;        // its cell's number
    const std::int32_t* cell_begin;  // first place of each cell; see cell_begin_size
};

/// Cells have a begin up to that far; those beyond the last cell begin after the last body. Kernels read
/// three cells of the next row, sixteen cells at a time.
constexpr std::size_t cell_begin_size(std::size_t cells, std::size_t width) {
    return cells + width + 20;
}

/// One size class of the grid. Its cells are larger than twice its largest reach.
template <class Real>
struct GridLevel {
    SortedBodies<Real> bodies;
    std::size_t places;  // bodies of the level
    CellNumbering numbering;
    std::int32_t width, cells;  // of the numbering
    Real largest_reach;         // m
};

/// Candidate pairs of the bodies at places [first, last) with later bodies of their own level.
template <class Real>
struct FindCandidates {
    const GridLevel<Real>* level;
    std::size_t first, last;
    std::int32_t* a;  // out, rows
    std::int32_t* b;
    std::size_t capacity;
    std::size_t count;  // in and out: pairs in a and b
};

/// Pairs of bodies in rectangles: of which may the rectangles come to overlap?
template <class Real>
struct DropParted {
    const Real* pose;     // [rows][4]: x, y of the centre [m], cosine and sine of the angle
    const Real* size;     // [rows][4]: half sides [m]; what it may yet grow by on every side [m]; unused
    std::int32_t *a, *b;  // in and out: rows, [padded(count)], all below the length of the columns
    std::size_t count;
};

/// All bodies of a level with distance to (x, y) < reach + theirs.
template <class Real>
struct FindNear {
    Real x, y, reach;   // m
    std::int32_t* out;  // rows
    std::size_t capacity;
};

inline constexpr std::size_t kNoRoom = static_cast<std::size_t>(-1);

}  // namespace carom

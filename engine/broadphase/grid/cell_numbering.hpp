#pragma once

#include "kernels/broadphase/broadphase_arguments.hpp"

namespace carom {

/// Cells for bodies whose positions lie in a box.
/// @param x, y    m, [count]
/// @param count   at least one; memory is O(count) wherever the bodies are
/// @param size    m, the side of a cell
template <class Real>
CellNumbering number_cells(const FindBounds<Real>& bounds, const Real* x, const Real* y, std::size_t count,
                           double size);

}  // namespace carom

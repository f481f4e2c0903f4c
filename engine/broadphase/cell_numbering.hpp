#pragma once

#include "kernels/broadphase_arguments.hpp"

namespace carom {

/// Cells for bodies whose positions lie in a box.
/// @param size  m, the side of a cell
/// @param bodies  at least one; memory is O(bodies) wherever they are
template <class Real>
CellNumbering number_cells(const FindBounds<Real>& bounds, double size, std::size_t bodies);

}  // namespace carom

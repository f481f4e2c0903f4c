#pragma once

#include <cstddef>
#include <vector>

#include "report/page/markup.hpp"
#include "report/readers/h5_reader.hpp"

namespace carom::report {

/// The boundary of a box, capsule or polygon, as it is drawn: a polygon in the body's frame, in which round
/// corners are arcs of short lines. Of a compound one such polygon a piece.
struct DrawnShape {
    std::vector<double> x, y;         // m
    std::vector<std::size_t> starts;  // where a polygon begins
    double mark = 0;  // m, of the line from the centre along the body's x that shows how it turns
};

/// Those that a trajectory's settings list.
std::vector<DrawnShape> drawn_shapes(const Json& settings);

/// Which of them each body has, or -1; empty if none has any.
std::vector<double> shape_of_bodies(const H5Reader& trajectory);

}  // namespace carom::report

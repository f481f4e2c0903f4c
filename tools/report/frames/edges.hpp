#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "report/page/markup.hpp"

namespace carom::report {

/// A body that is lines, a segment or a chain: its points in its own frame.
struct EdgeBody {
    std::size_t body;
    std::vector<double> x, y;  // m; a loop ends with the point it began with
    double reach = 0;          // m, from the body's position to the farthest point
};

/// Those that a trajectory's settings name.
std::vector<EdgeBody> edge_bodies(const Json& settings);

/// A joint as it is drawn: a line between two points, each in the frame of its body or, where that is below
/// zero, of the world.
struct JointLine {
    std::ptrdiff_t a, b;
    double ax, ay, bx, by;                                   // m
    double until = std::numeric_limits<double>::infinity();  // s: it breaks then
};

/// Those that a trajectory's settings name.
/// @param breaks  [[joint, s], ...]: of a trajectory's attribute, or nothing
std::vector<JointLine> joint_lines(const Json& settings, const Json& breaks);

}  // namespace carom::report

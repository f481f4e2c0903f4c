#include "report/frames/shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace carom::report {
namespace {

constexpr double kArc = std::numbers::pi / 12;  // of a round corner that a line stands for
constexpr double kMark = 0.8;                   // length of the mark in inradii

double direction_of(double x, double y) {
    return std::atan2(y, x);
}

/// Appends the corner at (x, y) between the sides with the outward directions `from` and `to` [rad].
void add_corner(DrawnShape& shape, double x, double y, double radius, double from, double to) {
    if (radius == 0) {
        shape.x.push_back(x), shape.y.push_back(y);
        return;
    }
    const double turn = to > from ? to - from : to - from + 2 * std::numbers::pi;
    const double lines = std::ceil(turn / kArc);
    for (double n = 0; n <= lines; ++n) {
        const double angle = from + turn * n / lines;
        shape.x.push_back(x + radius * std::cos(angle)), shape.y.push_back(y + radius * std::sin(angle));
    }
}

/// From the centre to the nearest side of the polygon that was added last; below zero where the centre is
/// outside.
double inradius_of(const DrawnShape& shape) {
    double least = INFINITY;
    const std::size_t first = shape.starts.back(), count = shape.x.size() - first;
    for (std::size_t i = first; i < shape.x.size(); ++i) {
        const std::size_t next = first + (i - first + 1) % count;
        const double along_x = shape.x[next] - shape.x[i], along_y = shape.y[next] - shape.y[i];
        const double length = std::hypot(along_x, along_y);
        if (length > 0) least = std::min(least, (shape.x[i] * along_y - shape.y[i] * along_x) / length);
    }
    return least;
}

void add_polygon(const Json& outline, DrawnShape& shape) {
    std::vector<std::array<double, 2>> vertices;
    for (const Json& vertex : outline.at("vertices")) vertices.push_back({vertex.at(0), vertex.at(1)});
    const double radius = outline.at("radius");
    const std::size_t count = vertices.size();
    shape.starts.push_back(shape.x.size());
    if (count == 1) return add_corner(shape, vertices[0][0], vertices[0][1], radius, 0, 0);
    const auto normal = [&](std::size_t from) {  // outward, of the side that begins at a vertex
        const auto &a = vertices[from % count], &b = vertices[(from + 1) % count];
        return direction_of(b[1] - a[1], a[0] - b[0]);
    };
    for (std::size_t i = 0; i < count; ++i)
        add_corner(shape, vertices[i][0], vertices[i][1], radius, normal(i + count - 1), normal(i));
}

DrawnShape drawn(const Json& outline) {
    DrawnShape shape;
    const auto add = [&](const Json& polygon) {
        add_polygon(polygon, shape);
        shape.mark = std::max(shape.mark, kMark * inradius_of(shape));
    };
    if (!outline.contains("pieces")) {
        add(outline);
    } else {
        for (const Json& piece : outline.at("pieces")) add(piece);
    }
    return shape;
}

}  // namespace

std::vector<DrawnShape> drawn_shapes(const Json& settings) {
    std::vector<DrawnShape> shapes;
    if (!settings.is_object() || !settings.contains("shapes")) return shapes;
    for (const Json& outline : settings.at("shapes")) shapes.push_back(drawn(outline));
    return shapes;
}

std::vector<double> shape_of_bodies(const H5Reader& trajectory) {
    return trajectory.has("shape") ? trajectory.body_column("shape") : std::vector<double>{};
}

}  // namespace carom::report

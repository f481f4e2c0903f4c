#include "shapes/convex_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Twice the area between the vertices; negative if they go clockwise.
double twice_area(const Outline& outline) {
    double sum = 0;
    for (int i = 0; i < outline.count; ++i) {
        const Vec2 first = outline.vertices[0], v = outline.vertices[static_cast<std::size_t>(i)];
        sum += cross(v - first, outline.after(i) - first);
    }
    return sum;
}

Outline outline_of(const Polygon& polygon) {
    Outline outline;
    outline.count = static_cast<int>(std::min<std::size_t>(polygon.vertices.size(), kMostVertices));
    outline.radius = polygon.radius;
    std::copy_n(polygon.vertices.begin(), outline.count, outline.vertices.begin());
    if (twice_area(outline) < 0)
        std::reverse(outline.vertices.begin(), outline.vertices.begin() + outline.count);
    return outline;
}

/// The outline around its centroid.
Outline centred_outline_of(const Shape& shape) {
    Outline outline = outline_of(shape);
    if (!std::holds_alternative<Polygon>(shape)) return outline;  // the others are given around it
    const Vec2 centroid = mass_properties_of(shape).centroid;
    for (Vec2& vertex : outline.vertices) vertex -= centroid;
    return outline;
}

/// Outward, of the edge that begins at vertex i; zero for the one vertex of a disc.
Vec2 normal_of_edge(const Outline& outline, int i) {
    const Vec2 along = outline.after(i) - outline.vertices[static_cast<std::size_t>(i)];
    const double length = std::sqrt(length_squared(along));
    if (!(length > 0)) return {};
    return {along.y / length, -along.x / length};
}

}  // namespace

static_assert(kLargestPolygonVertices == kMostVertices);

bool is_convex(const Shape& shape) {
    return has_area(shape) && !std::holds_alternative<Compound>(shape);
}

bool has_area(const Shape& shape) {
    return !std::holds_alternative<Segment>(shape) && !std::holds_alternative<Chain>(shape);
}

Outline outline_of(const Shape& shape) {
    if (const auto* polygon = std::get_if<Polygon>(&shape)) return outline_of(*polygon);
    if (const auto* disc = std::get_if<Disc>(&shape)) return {{}, 1, disc->radius};
    if (const auto* box = std::get_if<Box>(&shape)) {
        const double x = 0.5 * box->width, y = 0.5 * box->height;
        return {{{{-x, -y}, {x, -y}, {x, y}, {-x, y}}}, 4, 0};
    }
    if (const auto* capsule = std::get_if<Capsule>(&shape)) {
        const double x = 0.5 * capsule->length;
        return {{{{-x, 0}, {x, 0}}}, 2, capsule->radius};
    }
    return {};
}

Polygon recentred(const Polygon& polygon) {
    const Outline outline = centred_outline_of(polygon);
    return {{outline.vertices.begin(), outline.vertices.begin() + outline.count}, outline.radius};
}

namespace {

template <class Real>
ConvexShape<Real> convex_shape_of(const Outline& outline) {
    ConvexShape<Real> convex{};
    double extent = 0, inradius = outline.count > 2 ? std::numeric_limits<double>::infinity() : 0;
    for (int i = 0; i < kMostVertices; ++i) {
        const int k = std::min(i, outline.count - 1);
        const Vec2 v = outline.vertices[static_cast<std::size_t>(k)], n = normal_of_edge(outline, k);
        convex.x[i] = static_cast<Real>(v.x), convex.y[i] = static_cast<Real>(v.y);
        convex.normal_x[i] = static_cast<Real>(n.x), convex.normal_y[i] = static_cast<Real>(n.y);
        extent = std::fmax(extent, std::sqrt(length_squared(v)));
        inradius = std::fmin(inradius, dot(n, v));
    }
    convex.radius = static_cast<Real>(outline.radius);
    convex.extent = static_cast<Real>(extent + outline.radius);
    convex.inradius = static_cast<Real>(inradius + outline.radius);
    convex.count = outline.count;
    return convex;
}

}  // namespace

template <class Real>
ConvexShape<Real> convex_shape_of(const Shape& shape) {
    return convex_shape_of<Real>(centred_outline_of(shape));
}

template <class Real>
ConvexShape<Real> convex_shape_of(const Shape& shape, Vec2 centre, double angle) {
    Outline outline = centred_outline_of(shape);
    const Real inradius = convex_shape_of<Real>(outline).inradius;
    const Rotation turn = rotation_by(angle);
    for (Vec2& vertex : outline.vertices) vertex = centre + rotate(turn, vertex);
    ConvexShape<Real> convex = convex_shape_of<Real>(outline);
    convex.inradius = inradius;
    return convex;
}

template <class Real>
double reach_along(const ConvexShape<Real>& shape, Rotation turn, Vec2 direction) {
    const Vec2 own = rotate_back(turn, direction);
    double reach = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < shape.count; ++i) reach = std::fmax(reach, dot(own, {shape.x[i], shape.y[i]}));
    return reach + static_cast<double>(shape.radius);
}

template ConvexShape<float> convex_shape_of(const Shape&);
template ConvexShape<double> convex_shape_of(const Shape&);
template ConvexShape<float> convex_shape_of(const Shape&, Vec2, double);
template ConvexShape<double> convex_shape_of(const Shape&, Vec2, double);
template double reach_along(const ConvexShape<float>&, Rotation, Vec2);
template double reach_along(const ConvexShape<double>&, Rotation, Vec2);

}  // namespace carom

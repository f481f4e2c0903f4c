#include <carom/shapes.hpp>

#include <cmath>

#include "math/angle.hpp"
#include "math/vec2_math.hpp"
#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"

namespace carom {
namespace {

/// Integrals over an area: of 1, of the place and of its squared distance from the origin.
struct Moments {
    double area = 0;    // m²
    Vec2 first;         // m³
    double second = 0;  // m⁴

    Moments& operator+=(const Moments& more) {
        area += more.area, first += more.first, second += more.second;
        return *this;
    }
};

/// Moments of the triangle from the origin to the edge from a to b; negative if they lie clockwise.
Moments of_triangle(Vec2 a, Vec2 b) {
    const double twice = cross(a, b);
    return {twice / 2, (twice / 6) * (a + b), twice / 12 * (dot(a, a) + dot(a, b) + dot(b, b))};
}

/// Moments of the rectangle that an edge from a to b becomes when it moves by `radius` along its normal.
Moments of_side(Vec2 a, Vec2 b, Vec2 normal, double radius) {
    const double squared = length_squared(b - a), area = std::sqrt(squared) * radius;
    const Vec2 centre = 0.5 * (a + b + radius * normal);
    return {area, area * centre, area * (length_squared(centre) + (squared + radius * radius) / 12)};
}

/// Moments of the sector of a disc around `centre`, counter-clockwise from one direction to another.
/// @param angle  between them [rad]
Moments of_sector(Vec2 centre, double radius, Vec2 from, Vec2 to, double angle) {
    const double area = 0.5 * angle * radius * radius;
    // The integral of the direction over the angle is the difference of the ends, turned by a quarter.
    const Vec2 lever = (radius * radius * radius / 3) * Vec2{to.y - from.y, from.x - to.x};
    return {area, area * centre + lever,
            area * (length_squared(centre) + 0.5 * radius * radius) + 2 * dot(centre, lever)};
}

Vec2 normal_of(Vec2 a, Vec2 b) {
    const Vec2 along = b - a;
    const double length = std::sqrt(length_squared(along));
    return {along.y / length, -along.x / length};
}

MassProperties properties_of(const Outline& outline) {
    const auto vertex = [&](int i) { return outline.vertices[static_cast<std::size_t>(i % outline.count)]; };
    Vec2 middle;
    for (int i = 0; i < outline.count; ++i) middle += (1.0 / outline.count) * vertex(i);
    Moments sum;
    for (int i = 0; i < outline.count; ++i) {
        const Vec2 a = vertex(i) - middle, b = vertex(i + 1) - middle, c = vertex(i + 2) - middle;
        sum += of_triangle(a, b);
        if (!(outline.radius > 0)) continue;
        const Vec2 n = normal_of(a, b), next = normal_of(b, c);
        const double angle = std::fabs(angle_of({dot(n, next), cross(n, next)}));
        sum += of_side(a, b, n, outline.radius);
        sum += of_sector(b, outline.radius, n, next, angle);
    }
    const Vec2 centroid = (1 / sum.area) * sum.first;
    return {sum.area, middle + centroid, sum.second - sum.area * length_squared(centroid)};
}

}  // namespace

MassProperties mass_properties_of(const Shape& shape) {
    if (const auto* disc = std::get_if<Disc>(&shape)) {
        const double squared = disc->radius * disc->radius, area = kPi * squared;
        return {area, {}, 0.5 * area * squared};
    }
    if (const auto* compound = std::get_if<Compound>(&shape)) {
        const CompoundMass of = compound_mass_of(*compound, Material{});
        return {of.area, of.centre, of.mass > 0 ? of.inertia / of.mass * of.area : 0};
    }
    const Outline outline = outline_of(shape);
    return outline.count > 1 ? properties_of(outline) : MassProperties{};
}

}  // namespace carom

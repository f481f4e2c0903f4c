#include <carom/shapes.hpp>

#include "math/angle.hpp"
#include "shapes/convex_geometry.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace test_mass_properties {

using namespace carom;

namespace {

/// The boundary of a rounded polygon as one with very many corners: the oracle knows nothing of sectors.
std::vector<Vec2> boundary_of(const Outline& outline, int corners) {
    std::vector<Vec2> boundary;
    for (int k = 0; k < corners; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.5) / corners;
        const Vec2 out{std::cos(angle), std::sin(angle)};
        const auto reach = [&](Vec2 v) { return v.x * out.x + v.y * out.y; };
        const auto farthest =
            *std::max_element(outline.vertices.begin(), outline.vertices.begin() + outline.count,
                              [&](Vec2 a, Vec2 b) { return reach(a) < reach(b); });
        boundary.push_back({farthest.x + outline.radius * out.x, farthest.y + outline.radius * out.y});
    }
    return boundary;
}

/// Integrals over a polygon by its trapezia under the edges: another formula than that of the engine, which
/// takes triangles from a point.
MassProperties integrate(const std::vector<Vec2>& p) {
    double area = 0, x = 0, y = 0, xx = 0, yy = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        const Vec2 a = p[i], b = p[(i + 1) % p.size()];
        const double dx = a.x - b.x, dy = b.y - a.y;
        area += dx * (a.y + b.y) / 2;
        y += dx * (a.y * a.y + a.y * b.y + b.y * b.y) / 6;
        yy += dx * (a.y + b.y) * (a.y * a.y + b.y * b.y) / 12;
        x += dy * (a.x * a.x + a.x * b.x + b.x * b.x) / 6;
        xx += dy * (a.x + b.x) * (a.x * a.x + b.x * b.x) / 12;
    }
    return {area, {x / area, y / area}, xx + yy - (x * x + y * y) / area};
}

Polygon random_polygon(std::mt19937_64& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const int count = 3 + static_cast<int>(random() % 6);
    std::vector<double> angles;
    for (int i = 0; i < count; ++i) angles.push_back(2 * std::numbers::pi * (i + 0.8 * unit(random)) / count);
    const double wide = 0.2 + 3 * unit(random), high = 0.2 + 3 * unit(random);
    const Vec2 middle{10 * unit(random) - 5, 10 * unit(random) - 5};
    Polygon polygon;
    for (const double angle : angles)
        polygon.vertices.push_back({middle.x + wide * std::cos(angle), middle.y + high * std::sin(angle)});
    if (random() % 2) std::reverse(polygon.vertices.begin(), polygon.vertices.end());
    polygon.radius = random() % 3 ? unit(random) : 0;
    return polygon;
}

void check_properties(const Shape& shape, const MassProperties& expected, double tolerance) {
    const MassProperties of = mass_properties_of(shape);
    const double size = std::sqrt(expected.area);
    CHECK(of.area == doctest::Approx(expected.area).epsilon(tolerance));
    CHECK(std::abs(of.centroid.x - expected.centroid.x) < tolerance * size);
    CHECK(std::abs(of.centroid.y - expected.centroid.y) < tolerance * size);
    CHECK(of.second_moment == doctest::Approx(expected.second_moment).epsilon(tolerance));
}

}  // namespace

TEST_CASE("the angle of a turn is that of atan2 to rounding") {
    for (int k = -2000; k <= 2000; ++k) {
        const double angle = std::numbers::pi * k / 2000.0;
        const double found = angle_of({std::cos(angle), std::sin(angle)});
        CHECK(std::abs(found - std::atan2(std::sin(angle), std::cos(angle))) <= 1e-15);
    }
    CHECK(angle_of({-1, 0}) == std::numbers::pi);
    CHECK(angle_of({1, 0}) == 0);
    CHECK(angle_of({1, 1e-9}) == doctest::Approx(1e-9).epsilon(1e-15));
    CHECK(angle_of({-1, -1e-9}) == doctest::Approx(1e-9 - std::numbers::pi).epsilon(1e-15));
}

TEST_CASE("a box has width times height, and its moment is area (w² + h²) / 12") {
    check_properties(Box{3, 0.5}, {1.5, {}, 1.5 * (9 + 0.25) / 12}, 1e-15);
    check_properties(Box{1e-3, 1}, {1e-3, {}, 1e-3 * (1e-6 + 1) / 12}, 1e-15);
}

TEST_CASE("a capsule is a box and two half discs") {
    const double l = 2, r = 0.3, pi = std::numbers::pi, disc = pi * r * r, box = 2 * r * l;
    const double off = 4 * r / (3 * pi);  // of a half disc's centroid from its flat side
    const double half = disc * r * r / 4 - disc / 2 * off * off;  // about its centroid
    const double out = l / 2 + off;
    check_properties(Capsule{l, r},
                     {box + disc, {}, box * (l * l + 4 * r * r) / 12 + 2 * (half + disc / 2 * out * out)},
                     1e-14);
}

TEST_CASE("area, centroid and moment of rounded polygons are those of a boundary with 200,000 corners") {
    std::mt19937_64 random(7);
    for (int round = 0; round < carom::test::scaled(60, 6); ++round) {
        CAPTURE(round);
        const Shape shape = random_polygon(random);
        check_properties(shape, integrate(boundary_of(outline_of(shape), 200000)), 2e-9);
    }
}

TEST_CASE("moments do not depend on where and in which order a polygon's vertices are given") {
    const Polygon polygon{{{0, 0}, {2, 0}, {2.5, 1}, {0.5, 1.5}}, 0.2};
    Polygon other{{polygon.vertices.rbegin(), polygon.vertices.rend()}, polygon.radius};
    for (Vec2& vertex : other.vertices) vertex.x += 1000, vertex.y -= 500;
    const MassProperties of = mass_properties_of(polygon), moved = mass_properties_of(other);
    CHECK(moved.area == doctest::Approx(of.area).epsilon(1e-12));
    CHECK(moved.second_moment == doctest::Approx(of.second_moment).epsilon(1e-11));
    CHECK(moved.centroid.x - 1000 == doctest::Approx(of.centroid.x).epsilon(1e-12));
    CHECK(moved.centroid.y + 500 == doctest::Approx(of.centroid.y).epsilon(1e-12));
}

TEST_CASE("segments and chains have no area") {
    CHECK(mass_properties_of(Segment{}).area == 0);
    CHECK(mass_properties_of(Chain{{{0, 0}, {1, 0}, {1, 1}}, true}).second_moment == 0);
}

}  // namespace test_mass_properties

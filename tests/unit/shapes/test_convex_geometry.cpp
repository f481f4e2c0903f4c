#include "shapes/convex_geometry.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

namespace test_convex_geometry {

using namespace carom;

namespace {

const Polygon kKite{{{3, 1}, {1, 0}, {0, 1}, {1, 3}}, 0.25};

double distance_to_edges(const ConvexShape<double>& shape, double x, double y) {
    double least = INFINITY;
    for (int i = 0; i < shape.count; ++i)
        least = std::min(least, shape.normal_x[i] * (shape.x[i] - x) + shape.normal_y[i] * (shape.y[i] - y));
    return least + shape.radius;
}

}  // namespace

TEST_CASE("a box's sides and normals are exact, counter-clockwise from the lower left corner") {
    const auto box = convex_shape_of<float>(Box{3, 1});
    const float x[] = {-1.5f, 1.5f, 1.5f, -1.5f}, y[] = {-0.5f, -0.5f, 0.5f, 0.5f};
    const float normal_x[] = {0, 1, 0, -1}, normal_y[] = {-1, 0, 1, 0};
    CHECK(box.count == 4);
    for (int i = 0; i < kMostVertices; ++i) {
        const int k = std::min(i, 3);
        CHECK(box.x[i] == x[k]);
        CHECK(box.y[i] == y[k]);
        CHECK(box.normal_x[i] == normal_x[k]);
        CHECK(box.normal_y[i] == normal_y[k]);
    }
    CHECK(box.radius == 0);
    CHECK(box.extent == std::sqrt(2.5f));
    CHECK(box.inradius == 0.5f);
}

TEST_CASE("a disc has one vertex without a normal, a capsule two with both sides") {
    const auto disc = convex_shape_of<double>(Disc{0.7});
    CHECK(disc.count == 1);
    CHECK(disc.x[7] == 0);
    CHECK(disc.normal_x[0] == 0);
    CHECK(disc.normal_y[0] == 0);
    CHECK(disc.extent == 0.7);
    CHECK(disc.inradius == 0.7);
    const auto capsule = convex_shape_of<double>(Capsule{2, 0.25});
    CHECK(capsule.count == 2);
    CHECK(capsule.x[0] == -1);
    CHECK(capsule.x[7] == 1);
    CHECK(capsule.normal_y[0] == -1);
    CHECK(capsule.normal_y[1] == 1);
    CHECK(capsule.extent == 1.25);
    CHECK(capsule.inradius == 0.25);
}

TEST_CASE("a polygon given clockwise is turned round, and its centroid comes to lie at the origin") {
    const auto kite = convex_shape_of<double>(kKite);
    CHECK(kite.count == 4);
    for (int i = 0; i < kite.count; ++i) {
        const int next = (i + 1) % kite.count;
        const double along_x = kite.x[next] - kite.x[i], along_y = kite.y[next] - kite.y[i];
        CHECK(kite.normal_x[i] * kite.normal_x[i] + kite.normal_y[i] * kite.normal_y[i] ==
              doctest::Approx(1).epsilon(1e-15));
        CHECK(std::abs(kite.normal_x[i] * along_x + kite.normal_y[i] * along_y) < 1e-15);
        CHECK(along_x * kite.normal_y[i] - along_y * kite.normal_x[i] < 0);  // outward
    }
    const Vec2 centroid = mass_properties_of(recentred(kKite)).centroid;
    CHECK(std::abs(centroid.x) < 1e-15);
    CHECK(std::abs(centroid.y) < 1e-15);
    CHECK(kite.inradius == doctest::Approx(distance_to_edges(kite, 0, 0)).epsilon(1e-15));
}

TEST_CASE("a shape reaches in a direction as far as its farthest point does") {
    const auto kite = convex_shape_of<double>(kKite);
    for (int k = 0; k < 100; ++k) {
        const Rotation turn = rotation_by(0.1 * k);
        const Vec2 out{std::cos(0.37 * k), std::sin(0.37 * k)};
        double farthest = -INFINITY;
        for (int i = 0; i < kite.count; ++i)
            for (int n = 0; n < 3600; ++n) {
                const double angle = std::numbers::pi * n / 1800;
                const Vec2 point = rotate(turn, {kite.x[i] + kite.radius * std::cos(angle),
                                                 kite.y[i] + kite.radius * std::sin(angle)});
                farthest = std::max(farthest, point.x * out.x + point.y * out.y);
            }
        const double reach = reach_along(kite, turn, out);
        CHECK(reach >= farthest - 1e-12);
        CHECK(reach < farthest + 1e-6);
        CHECK(reach <= kite.extent + 1e-12);
        CHECK(reach >= kite.inradius - 1e-12);
    }
}

}  // namespace test_convex_geometry

#include <carom/scene.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

namespace test_shape_validation {

using namespace carom;

namespace {

struct Refused {
    Shape shape;
    ErrorCode code;
    std::string pointer;    // behind "/bodies/0/shape/"
    std::string statement;  // a part of it
};

void check_refused(const Refused& refused) {
    Scene scene;
    scene.add({.name = "it", .shape = refused.shape});
    const auto found = scene.find_problem();
    REQUIRE(found.has_value());
    CAPTURE(found->statement);
    CHECK(found->code == refused.code);
    CHECK(found->pointer == "/bodies/0/shape/" + refused.pointer);
    CHECK(found->statement.find("body 0 (\"it\") has ") == 0);
    CHECK(found->statement.find(refused.statement) != std::string::npos);
}

Polygon regular(int count, double radius) {
    Polygon polygon;
    for (int i = 0; i < count; ++i) {
        const double angle = 2 * std::acos(-1) * i / count;
        polygon.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return polygon;
}

}  // namespace

TEST_CASE("shapes out of their limits are refused with the item, the value and the remedy") {
    constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
    const Refused refused[] = {
        {Box{-1, 1}, ErrorCode::out_of_range, "box/width", "width -1 m"},
        {Box{1, 0}, ErrorCode::out_of_range, "box/height", "height 0 m"},
        {Box{1, kNaN}, ErrorCode::not_finite, "box/height", ""},
        {Box{1, 2e7}, ErrorCode::out_of_range, "box/height", "height 2e+07 m"},
        {Capsule{1e7, 6e6}, ErrorCode::out_of_range, "capsule", "reaches 1.1e+07 m from its centre"},
        {Box{1, 1e-4}, ErrorCode::out_of_range, "box", "Make it thicker, or shorter."},
        {Capsule{0, 1}, ErrorCode::out_of_range, "capsule/length", "without length is a disc"},
        {Capsule{1, 0}, ErrorCode::out_of_range, "capsule/radius", "radius 0 m"},
        {Capsule{10, 1e-3}, ErrorCode::out_of_range, "capsule", "1000 times half of the thickness"},
    };
    for (const Refused& each : refused) check_refused(each);
}

TEST_CASE("polygons that are not convex, or hardly, are refused with the vertex that is to blame") {
    const auto inconsistent = ErrorCode::inconsistent, out = ErrorCode::out_of_range;
    check_refused(
        {Polygon{{{0, 0}, {1, 0}}, 1}, out, "polygon/vertices", "a polygon of 2 vertices; expected 3 to 8"});
    check_refused({regular(9, 1), out, "polygon/vertices", "a polygon of 9 vertices; expected 3 to 8"});
    check_refused({Polygon{{{0, 0}, {1, 0}, {0, 1}}, -1}, out, "polygon/radius", "radius -1 m"});
    check_refused({Polygon{{{0, 0}, {1, 0}, {0, 2e7}}, 0}, out, "polygon/vertices/2/1", "vertex y 2e+07 m"});
    check_refused({Polygon{{{0, 0}, {1, 0}, {0.2, 0.2}, {0, 1}}, 0}, inconsistent, "polygon/vertices/2",
                   "a dent at vertex 2"});
    check_refused({Polygon{{{0, 0}, {0, 1}, {0.2, 0.2}, {1, 0}}, 0}, inconsistent, "polygon/vertices/2",
                   "a dent at vertex 2"});
    check_refused({Polygon{{{0, 0}, {1, 0}, {2, 1e-5}, {0, 1}}, 0}, inconsistent, "polygon/vertices/1",
                   "on one line with those beside it"});
    check_refused({Polygon{{{0, 0}, {1, 0}, {1, 0}, {0, 1}}, 0}, out, "polygon/vertices/2",
                   "vertices 1 and 2 that are 0 m apart"});
    check_refused({Polygon{{{0, 0}, {10, 0}, {10, 1e-3}, {0, 10}}, 0}, out, "polygon/vertices/2",
                   "vertices 1 and 2 that are 0.001 m apart"});
    const std::vector<Vec2> round = regular(5, 1).vertices;
    const Polygon star{{round[0], round[2], round[4], round[1], round[3]}, 0};
    check_refused({star, inconsistent, "polygon/vertices/3", "in their order around it"});
}

TEST_CASE("polygons of 3 to 8 vertices in either order are sound, rounded or not, thin to a five-hundredth") {
    Scene scene;
    for (int count = 3; count <= 8; ++count) {
        Polygon polygon = regular(count, 0.5);
        scene.add({.shape = polygon});
        polygon.radius = 0.1;
        scene.add({.shape = Polygon{{polygon.vertices.rbegin(), polygon.vertices.rend()}, 0.1}});
    }
    scene.add({.shape = Box{10, 0.0101}});
    scene.add({.shape = Capsule{1, 0.001}});
    CHECK_FALSE(scene.find_problem().has_value());
}

TEST_CASE("a box must fit between the walls however it turns, and its density gives its mass by its area") {
    Scene scene;
    scene.walls = Walls{.min = {0, 0}, .max = {4, 4}};
    scene.add({.shape = Box{8, 4.5}, .position = {2, 2}});
    const auto found = scene.find_problem();
    REQUIRE(found.has_value());
    CHECK(found->pointer == "/bodies/0/shape/box");
    CHECK(found->statement.find("thickness 4.5 m") != std::string::npos);
    scene.bodies[0].shape = Box{1e-8, 1e-8}, scene.bodies[0].material.density = 1e-20;
    REQUIRE(scene.find_problem().has_value());
    CHECK(scene.find_problem()->pointer == "/bodies/0/material/density");
}

TEST_CASE("the largest reach of a scene is held against the smallest inradius") {
    Scene scene;
    scene.add({.shape = Box{1e-3, 1e-5}});
    scene.add({.type = BodyType::static_body, .shape = Box{1e3, 1e3}, .position = {0, -600}});
    const auto found = scene.find_problem();
    REQUIRE(found.has_value());
    CHECK(found->pointer == "/bodies/1/shape/box");
}

}  // namespace test_shape_validation

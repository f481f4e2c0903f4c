#include <carom/generators.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <string>

namespace test_shape_generators {

using namespace carom;

namespace {

template <class Generator>
void check_refused(const Generator& generator, ErrorCode code, const std::string& pointer,
                   const std::string& words) {
    const auto found = find_problem(generator);
    REQUIRE(found.has_value());
    CHECK(found->code == code);
    CHECK(found->pointer == pointer);
    CHECK_MESSAGE(found->statement.find(words) != std::string::npos, found->statement);
}

}  // namespace

TEST_CASE("a pyramid of base n has n (n + 1) / 2 boxes, each centred over the gap of the two below it") {
    Scene scene;
    scene.add(Body{});
    const BodyId first =
        add_pyramid(scene, {.base = 7, .origin = {2, 1}, .gap = 0.25, .body = {.shape = Box{2, 1}}});
    CHECK(first.index == 1);
    CHECK(scene.bodies.size() == 1 + 28);
    std::size_t row_begin = 1;
    for (std::size_t row = 0; row < 7; row_begin += 7 - row, ++row)
        for (std::size_t column = 0; column < 7 - row; ++column) {
            const Body& box = scene.bodies[row_begin + column];
            CHECK(std::get<Box>(box.shape).width == 2);
            CHECK(box.position.y == 1 + 1.25 * static_cast<double>(row));
            if (row == 0) {
                CHECK(box.position.x == 2 + 2.25 * static_cast<double>(column));
                continue;
            }
            const std::size_t below = row_begin - (7 - row + 1) + column;
            const double left = scene.bodies[below].position.x, right = scene.bodies[below + 1].position.x;
            CHECK(box.position.x == doctest::Approx((left + right) / 2).epsilon(1e-15));
        }
    CHECK_FALSE(scene.find_problem().has_value());
}

TEST_CASE("a pyramid is of boxes that are not turned, and no larger than a scene") {
    check_refused(Pyramid{.base = 0}, ErrorCode::out_of_range, "/base", "the pyramid has base 0");
    check_refused(Pyramid{.base = 20000}, ErrorCode::too_large, "/base", "200010000");
    check_refused(Pyramid{.gap = -1}, ErrorCode::out_of_range, "/gap", "gap -1 m");
    check_refused(Pyramid{.body = {.shape = Disc{1}}}, ErrorCode::inconsistent, "/shape", "expected a box");
    check_refused(Pyramid{.body = {.shape = Box{1, -1}}}, ErrorCode::out_of_range, "/shape/box/height",
                  "-1 m");
    check_refused(Pyramid{.body = {.shape = Box{1, 1}, .angle = 1}}, ErrorCode::inconsistent, "/angle",
                  "expected 0");
}

TEST_CASE("neighbours in a stack are a gap apart, whatever their shape and turn") {
    const auto step_of = [](Body body, double gap) {
        Scene scene;
        add_stack(scene, {.count = 3, .gap = gap, .body = std::move(body)});
        CHECK(scene.bodies[2].position.y == doctest::Approx(2 * scene.bodies[1].position.y).epsilon(1e-15));
        return scene.bodies[1].position.y;
    };
    const double quarter = std::acos(0.0);
    CHECK(step_of({.shape = Box{3, 0.5}}, 0.25) == 0.75);
    CHECK(step_of({.shape = Box{3, 0.5}, .angle = quarter}, 0) == doctest::Approx(3).epsilon(1e-12));
    CHECK(step_of({.shape = Box{1, 1}, .angle = quarter / 2}, 0) ==
          doctest::Approx(std::sqrt(2.0)).epsilon(1e-12));
    CHECK(step_of({.shape = Capsule{2, 0.25}}, 0.5) == 1);
    CHECK(step_of({.shape = Capsule{2, 0.25}, .angle = quarter}, 0) == doctest::Approx(2.5).epsilon(1e-12));
    const Polygon roof{{{0, 0}, {2, 0}, {1, 1}}, 0.1};  // 1 m high and its rounding
    CHECK(step_of({.shape = roof}, 0) == doctest::Approx(1.2).epsilon(1e-12));
    CHECK(step_of({.shape = Disc{0.3}}, 0.1) == 2 * 0.3 + 0.1);
}

TEST_CASE("a lattice places any shape with an area, and draws radii for discs alone") {
    Scene scene;
    add_lattice(scene, {.count_x = 3, .count_y = 2, .spacing = {4, 2}, .body = {.shape = Capsule{2, 0.5}}});
    CHECK(scene.bodies.size() == 6);
    CHECK(std::get<Capsule>(scene.bodies[5].shape).length == 2);
    CHECK(scene.bodies[5].position == Vec2{8, 2});
    check_refused(Lattice{.radius_range = RadiusRange{1, 2}, .body = {.shape = Box{1, 1}}},
                  ErrorCode::inconsistent, "/shape", "the shape \"box\" and radii");
    check_refused(Lattice{.body = {.type = BodyType::static_body, .shape = Segment{}}},
                  ErrorCode::inconsistent, "/shape",
                  "the shape \"segment\"; expected a disc, box, capsule, polygon or compound");
    Scene walled;
    walled.walls = Walls{.min = {0, 0}, .max = {10, 10}};
    CHECK_THROWS_WITH_AS(add_gas(walled, {.count = 3, .body = {.shape = Box{1, 1}}}),
                         doctest::Contains("expected a disc"), Error);
}

}  // namespace test_shape_generators

// Boxes, capsules and polygons in a world: columns, books, solvers that refuse them, changes between steps.
#include <carom/errors.hpp>
#include <carom/pairwise.hpp>
#include <carom/world.hpp>

#include "math/rotation.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace test_shapes {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;  // s

/// One of each shape, far apart: nothing touches.
Scene flying() {
    Scene scene;
    scene.gravity = {0, -9};
    scene.effects.ledger = true;
    const Polygon polygon{{{0, 0}, {2, 0}, {2, 1}, {0.5, 1.5}}, 0.1};
    const Shape shapes[] = {Box{2, 0.5}, Capsule{1, 0.25}, polygon, Disc{0.5}};
    double x = 0;
    for (const Shape& shape : shapes)
        scene.add({.shape = shape,
                   .position = {x += 20, 100},
                   .angle = 0.3,
                   .velocity = {1, 2},
                   .angular_velocity = 3,
                   .mass = 2});
    return scene;
}

bool has_column(const World& world, const std::string& name) {
    const Plan plan = world.plan();
    return std::any_of(plan.columns.begin(), plan.columns.end(),
                       [&](const ColumnReport& column) { return column.name == name; });
}

std::string refusal_of(const Scene& scene) {
    try {
        scene.validate();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("a shape that flies freely keeps its spin, and its energy of rotation is that of its moment") {
    const Scene scene = flying();
    World64 world(scene);
    double rotational = 0;
    for (const Body& body : scene.bodies) {
        const MassProperties of = mass_properties_of(body.shape);
        rotational += 0.5 * (2 * of.second_moment / of.area) * 9;  // spin² = 9
    }
    CHECK(world.ledger().energy.rotational == doctest::Approx(rotational).epsilon(1e-13));
    for (int i = 0; i < 120; ++i) world.step(kStep);
    const Ledger ledger = world.ledger();
    CHECK(ledger.energy.rotational == doctest::Approx(rotational).epsilon(1e-12));
    CHECK(ledger.energy.total() == doctest::Approx(ledger.initial.total()).epsilon(1e-12));
    for (std::uint32_t i = 0; i < 4; ++i) {
        const BodyState state = world.state({i, 0});
        CHECK(state.angular_velocity == doctest::Approx(3).epsilon(1e-13));
        CHECK(state.angle == doctest::Approx(0.3 + 3 * 2.0).epsilon(1e-12));
        CHECK(state.position.y == doctest::Approx(100 + 2 * 2.0 - 0.5 * 9 * 4).epsilon(1e-12));
    }
}

TEST_CASE("angular drag takes from the spin of every shape the same share") {
    Scene scene = flying();
    scene.drag.angular = 0.5;
    World64 world(scene);
    for (int i = 0; i < 60; ++i) world.step(kStep);
    for (std::uint32_t i = 0; i < 4; ++i)
        CHECK(world.state({i, 0}).angular_velocity == doctest::Approx(3 * std::exp(-0.5)).epsilon(1e-9));
    CHECK(std::abs(world.ledger().energy_by_cause.unexplained) < 1e-9);
}

TEST_CASE("a world says which shape a body has: a polygon around its centroid, a chain point for point") {
    Scene scene = flying();
    const Chain chain{{{0, 0}, {1, 0}, {1, 1}}, true};
    const BodyId hill = scene.add({.type = BodyType::static_body, .shape = chain, .position = {-50, 0}});
    const BodyId line = scene.add({.type = BodyType::static_body, .shape = Segment{{0, 1}, {2, 3}}});
    const World world(scene);
    CHECK(std::get<Box>(world.shape({0, 0})).width == 2);
    CHECK(std::get<Capsule>(world.shape({1, 0})).radius == 0.25);
    const auto polygon = std::get<Polygon>(world.shape({2, 0}));
    CHECK(polygon.vertices.size() == 4);
    CHECK(std::abs(mass_properties_of(polygon).centroid.x) < 1e-12);
    CHECK(std::get<Disc>(world.shape({3, 0})).radius == 0.5);
    CHECK(std::get<Chain>(world.shape(hill)).loop);
    CHECK(std::get<Chain>(world.shape(hill)).points == chain.points);
    CHECK(std::get<Segment>(world.shape(line)).b == Vec2{2, 3});
}

TEST_CASE("discs have no columns of shapes until the first other shape comes, and go on as they did") {
    Scene scene;
    scene.gravity = {0, -9};
    for (int i = 0; i < 5; ++i)
        scene.add({.position = {1.2 * i, 1}, .angular_velocity = 1.0 * i, .material = {.friction = 0.5}});
    scene.add(
        {.type = BodyType::static_body, .shape = Segment{{-10, 0}, {10, 0}}, .material = {.friction = 1}});
    World discs(scene), mixed(scene);
    for (int i = 0; i < 20; ++i) discs.step(kStep), mixed.step(kStep);
    CHECK_FALSE(has_column(mixed, "shape"));
    CHECK_FALSE(has_column(mixed, "rim"));
    const BodyId box = mixed.add({.shape = Box{1, 1}, .position = {500, 100}});
    CHECK(has_column(mixed, "shape"));
    CHECK(has_column(mixed, "rim"));
    CHECK(std::get<Disc>(mixed.shape({2, 0})).radius == 0.5);
    for (int i = 0; i < 60; ++i) discs.step(kStep), mixed.step(kStep);
    for (std::uint32_t i = 0; i < 5; ++i) {
        const BodyState alone = discs.state({i, 0}), beside = mixed.state({i, 0});
        CHECK(beside.position.x == doctest::Approx(alone.position.x).epsilon(1e-4));
        CHECK(beside.position.y == doctest::Approx(alone.position.y).epsilon(1e-4));
        CHECK(beside.angular_velocity == doctest::Approx(alone.angular_velocity).epsilon(1e-3));
    }
    mixed.remove(box);
    mixed.step(kStep);
    CHECK(mixed.body_count() == 6);
}

TEST_CASE("a plan counts the shapes that bodies share, and a world of discs has none") {
    Scene scene = flying();
    for (int i = 0; i < 10; ++i) scene.add({.shape = Box{2, 0.5}, .position = {10.0 * i, 300}});
    const Plan plan = World(scene).plan();
    CHECK(plan.shapes == 4);
    CHECK(plan.bytes_per_shape > 8 * 4 * sizeof(float));
    scene.bodies.erase(scene.bodies.begin(), scene.bodies.begin() + 3), scene.bodies.resize(1);
    CHECK(World(scene).plan().shapes == 0);
    CHECK(World(scene).plan().bytes_per_shape == 0);
}

TEST_CASE("shapes come and go between steps, and the others stay what they are") {
    World world(flying());
    std::vector<BodyId> added;
    for (int round = 0; round < 200; ++round) {
        Body body{.shape = Box{1 + 0.1 * (round % 7), 0.5}, .position = {-10.0 * round, 50}};
        if (round % 3 == 1) body.shape = Disc{0.25};
        if (round % 3 == 2) body.shape = Polygon{{{0, 0}, {1 + 0.1 * (round % 5), 0}, {0, 1}}, 0};
        added.push_back(world.add(body));
        if (round % 2) {
            world.remove(added[static_cast<std::size_t>(round / 2)]);
            world.step(kStep);
        }
    }
    CHECK(std::get<Box>(world.shape({0, 0})).width == 2);
    CHECK(std::get<Disc>(world.shape({3, 0})).radius == 0.5);
    for (int round = 100; round < 200; ++round) {
        const Shape shape = world.shape(added[static_cast<std::size_t>(round)]);
        if (round % 3 == 0) CHECK(std::get<Box>(shape).width == 1 + 0.1 * (round % 7));
        if (round % 3 == 1) CHECK(std::get<Disc>(shape).radius == 0.25);
        if (round % 3 == 2) CHECK(std::holds_alternative<Polygon>(shape));
    }
}

TEST_CASE("a world whose first body is a line steps boxes that touch each other") {
    Scene scene;
    scene.gravity = {0, -9};
    scene.add({.type = BodyType::static_body, .shape = Segment{{-5, -50}, {5, -50}}});
    for (int i = 0; i < 3; ++i) scene.add({.shape = Box{1, 1}, .position = {0.1 * i, 0.999 * i}});
    World world(scene);
    for (int i = 0; i < 10; ++i) world.step(kStep);
    CHECK(world.state({1, 0}).position.y < -0.1);
    CHECK(world.quarantined().empty());
}

TEST_CASE("a world of shapes that is restored goes on to the same bits") {
    World world(flying());
    for (int i = 0; i < 30; ++i) world.step(kStep);
    std::vector<std::byte> state(world.state_bytes());
    world.save_state(state);
    World other(Scene{});
    other.restore_state(state);
    other.add({.shape = Box{2, 0.5}, .position = {-100, 0}}),
        world.add({.shape = Box{2, 0.5}, .position = {-100, 0}});
    for (int i = 0; i < 30; ++i) world.step(kStep), other.step(kStep);
    CHECK(other.state_hash() == world.state_hash());
    CHECK(std::get<Polygon>(other.shape({2, 0})).vertices == std::get<Polygon>(world.shape({2, 0})).vertices);
}

TEST_CASE("auto takes soft for a world with a shape that is no disc, whatever its type") {
    for (const BodyType type : {BodyType::dynamic_body, BodyType::static_body, BodyType::kinematic_body}) {
        Scene scene;
        scene.add({.position = {0, 5}, .material = {.restitution = 1}});
        CHECK(World(scene).plan().solver == "impulse");
        scene.add({.type = type, .shape = Box{1, 1}, .material = {.restitution = 1}});
        const Plan plan = World(scene).plan();
        CHECK(plan.solver == "soft");
        CHECK(plan.solver_reason == "body 1 is a box");
    }
}

TEST_CASE("solvers of discs refuse other shapes and name the body, the reason and the remedy") {
    const std::pair<Shape, std::string> shapes[] = {
        {Box{1, 1}, "box"}, {Capsule{1, 0.5}, "capsule"}, {Polygon{{{0, 0}, {1, 0}, {0, 1}}, 0}, "polygon"}};
    for (const auto& [shape, name] : shapes)
        for (const Solver solver : {Solver::impulse, Solver::event}) {
            Scene scene;
            scene.add({.position = {0, 5}, .material = {.restitution = 1}});
            scene.accuracy.solver = solver;
            World world(scene);
            scene.add({.name = "it", .shape = shape, .material = {.restitution = 1}});
            const std::string message = refusal_of(scene);
            CAPTURE(message);
            CHECK(message.find("body 1 (\"it\") has the shape \"" + name + "\"") != std::string::npos);
            CHECK(message.find("knows discs only. Use \"soft\" or \"auto\"") != std::string::npos);
            CHECK_THROWS_WITH_AS(world.add(scene.bodies[1]), doctest::Contains("knows discs only"), Error);
            CHECK(world.body_count() == 1);
        }
}

TEST_CASE("a world with a box does not go on with a solver of discs") {
    World world(flying());
    CHECK_THROWS_WITH_AS(world.set_solver(Solver::impulse), doctest::Contains("the shape \"box\""), Error);
    CHECK(world.plan().solver == "soft");
}

TEST_CASE(
    "a box turns unless its rotation is fixed: the effect rotation is called for by the first one that "
    "does") {
    Scene scene;
    scene.gravity = {0, -9};
    scene.add({.shape = Box{1, 1}, .fixed_rotation = true});
    CHECK_FALSE(has_column(World(scene), "angle"));
    World world(scene);
    world.add({.shape = Box{1, 1}, .position = {5, 0}});
    CHECK(has_column(world, "angle"));
    scene.effects.rotation = false;
    CHECK(refusal_of(scene).empty());
    scene.add({.shape = Box{1, 1}, .position = {5, 0}});
    CHECK(refusal_of(scene).find("rotation forced off although it has body 1 with the shape \"box\"") !=
          std::string::npos);
}

TEST_CASE("overlaps of shapes are those of their surfaces, in inradii of the smaller one") {
    const double corner = std::acos(-1) / 4;
    Scene boxes;
    boxes.add({.shape = Box{2, 1}});
    boxes.add({.shape = Box{1, 4}, .position = {1.45, 1}});  // 0.05 m in the first one's side
    boxes.add({.shape = Disc{1}, .position = {-1.9, 0}});    // 0.1 m
    boxes.add({.shape = Capsule{2, 0.25}, .position = {20, 0}});
    boxes.add({.shape = Box{1, 1}, .position = {20, 0.24 + std::sqrt(0.5)}, .angle = corner});  // 0.01 m
    boxes.add({.shape = Polygon{{{0, 0}, {1, 0}, {0, 1}}, 0.1}, .position = {40, 0}});
    const OverlapReport report = World64(boxes).overlaps();
    CHECK(report.touching == 3);
    CHECK(report.max == doctest::Approx(0.1 / 0.5).epsilon(1e-6));
    CHECK(report.mean == doctest::Approx((0.05 / 0.5 + 0.1 / 0.5 + 0.01 / 0.25) / 3).epsilon(1e-6));
}

TEST_CASE("how deep shapes are in the edges of a chain is measured edge by edge") {
    Scene scene;
    scene.add({.type = BodyType::static_body,
               .shape = Chain{{{-5, 0}, {0, 0}, {5, 0}, {5, 5}}, false},
               .position = {1, 1},
               .angle = 0.3});
    const Rotation turn = rotation_by(0.3);
    const auto place = [&](Vec2 p) { return Vec2{1, 1} + rotate(turn, p); };
    scene.add({.shape = Box{1, 2}, .position = place({-3, 0.99}), .angle = 0.3});       // one edge, 0.01 m
    scene.add({.shape = Capsule{1, 0.5}, .position = place({0, 0.48}), .angle = 0.3});  // two, 0.02 m each
    scene.add({.shape = Box{1, 1}, .position = place({4.47, 2}), .angle = 0.3});  // the upright one, -0.03
    const OverlapReport report = World64(scene).overlaps();
    CHECK(report.touching == 3);
    CHECK(report.max == doctest::Approx(0.04).epsilon(1e-6));
    CHECK(report.mean == doctest::Approx((0.02 + 0.04 + 0.04) / 3).epsilon(1e-6));
}

TEST_CASE("how deep a turned box is in a wall is measured at its lowest corner") {
    Scene scene;
    scene.walls = Walls{.min = {0, 0}, .max = {10, 10}};
    const double half_diagonal = std::sqrt(0.5);
    scene.add({.shape = Box{1, 1}, .position = {5, half_diagonal - 0.05}, .angle = std::acos(-1) / 4});
    const OverlapReport report = World64(scene).overlaps();
    CHECK(report.touching == 1);
    CHECK(report.max == doctest::Approx(0.05 / 0.5).epsilon(1e-6));
}

}  // namespace test_shapes

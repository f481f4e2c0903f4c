// Shapes that pass corners under solver `soft`: what does not touch is not deflected, and what slides over
// the seam of two tiles goes on as on one slab (docs/decisions/0065-corners-that-pass.md).
#include "support/effort.hpp"
#include "support/report.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <variant>
#include <vector>

namespace test_passing_shapes {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kGravity = 9.81;

/// Shapes that reach 0.3 m below their centre.
std::vector<Shape> flying_shapes() {
    return {Box{0.8, 0.6}, Capsule{0.6, 0.3}, Polygon{{{-0.4, -0.3}, {0.4, -0.3}, {0, 0.6}}}};
}

Body smooth(Shape shape, Vec2 position, BodyType type = BodyType::dynamic_body) {
    return {.type = type, .shape = std::move(shape), .position = position, .material = {.friction = 0}};
}

struct Obstacle {
    std::string name;
    std::vector<Body> bodies;  // up to a height of zero, about x = 0
};

std::vector<Obstacle> obstacles() {
    const BodyType fixed = BodyType::static_body;
    Body heavy = smooth(Box{4, 1}, {0, -0.5});
    heavy.mass = 1000;
    return {{"a static box", {smooth(Box{4, 1}, {0, -0.5}, fixed)}},
            {"a heavy box", {heavy}},
            {"the end of a segment", {smooth(Segment{{0, -2}, {0, 0}}, {}, fixed)}},
            {"a segment below", {smooth(Segment{{-2, 0}, {2, 0}}, {}, fixed)}},
            {"the ridge of a chain", {smooth(Chain{{{-2, -2}, {0, 0}, {2, -2}}}, {}, fixed)}}};
}

/// Tiles 1 m wide from x = -0.5 on, their tops at a height of zero.
Scene tiled(const std::string& kind, int count) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const BodyType fixed = BodyType::static_body;
    Compound all;
    for (int i = 0; i < count; ++i) {
        const auto x = static_cast<double>(i);
        if (kind == "boxes") scene.add(smooth(Box{1, 1}, {x, -0.5}, fixed));
        if (kind == "segments") scene.add(smooth(Segment{{-0.5, 0}, {0.5, 0}}, {x, 0}, fixed));
        all.pieces.push_back({Box{1, 1}, {x, -0.5}});
    }
    if (kind == "pieces of one body") scene.add(smooth(all, {0.5 * (count - 1), -0.5}, fixed));
    return scene;
}

}  // namespace

TEST_SUITE("physics/passing shapes") {
    TEST_CASE_TEMPLATE("what passes a corner keeps its velocity", Real, float, double) {
        std::mt19937 random(1);
        std::uniform_real_distribution<double> uniform(0, 1);
        const int flights = scaled(12, 3);
        for (const Obstacle& obstacle : obstacles())
            for (const double speed : {3.0, 10.0, 30.0})
                for (const double clearance : {0.005, 0.02, 0.05}) {
                    double largest = 0;
                    for (int i = 0; i < flights; ++i)
                        for (const Shape& shape : flying_shapes()) {
                            Scene scene;
                            scene.accuracy.solver = Solver::soft;
                            for (const Body& body : obstacle.bodies) scene.add(body);
                            const double low = mass_properties_of(shape).centroid.y + 0.3;
                            Body body = smooth(shape, {-4 - 0.3 * speed * uniform(random), low + clearance});
                            body.velocity = {speed, 0};
                            const BodyId id = scene.add(body);
                            BasicWorld<Real> world(scene);
                            while (world.state(id).position.x < 4) world.step(kStep);
                            const Vec2 v = world.state(id).velocity;
                            largest = std::fmax(largest, std::hypot(v.x - speed, v.y) / speed);
                        }
                    report(obstacle.name, ", ", speed, " m/s, clear by ", clearance, " m: off by ", largest);
                    INFO(obstacle.name, ", ", speed, " m/s, clear by ", clearance, " m");
                    CHECK(largest < 0.01);
                }
    }

    TEST_CASE_TEMPLATE("what touches a corner is struck", Real, float, double) {
        for (const double speed : {3.0, 10.0, 30.0})
            for (const Obstacle& obstacle : obstacles()) {
                if (obstacle.name == "a segment below") continue;
                Scene scene;
                scene.accuracy.solver = Solver::soft;
                for (const Body& body : obstacle.bodies) scene.add(body);
                Body body = smooth(Box{0.8, 0.6}, {-4, 0.2});
                body.velocity = {speed, 0};
                const BodyId id = scene.add(body);
                BasicWorld<Real> world(scene);
                double deepest = 0;
                for (double time = 0; time < 8 / speed; time += kStep)
                    world.step(kStep), deepest = std::fmax(deepest, world.overlaps().max);
                INFO(obstacle.name, ", ", speed, " m/s");
                CHECK(world.state(id).velocity.x < 0.8 * speed);
                CHECK(deepest <
                      0.3);  // of its inradius: what is struck turns into the corner within the step
            }
    }

    TEST_CASE_TEMPLATE("smooth shapes slide over tiles as over one slab", Real, float, double) {
        for (const char* kind : {"boxes", "segments", "pieces of one body"})
            for (const double speed : {1.0, 3.0, 15.0})
                for (const Shape& shape : flying_shapes()) {
                    Scene scene = tiled(kind, 40);
                    const double low = mass_properties_of(shape).centroid.y + 0.3;
                    Body body = smooth(shape, {1, low});
                    body.velocity = {speed, 0};
                    const BodyId id = scene.add(body);
                    BasicWorld<Real> world(scene);
                    double highest = 0;
                    for (int i = 0; i < 120; ++i) {
                        world.step(kStep);
                        highest = std::fmax(highest, world.state(id).position.y - low);
                    }
                    INFO(kind, ", ", speed, " m/s");
                    CHECK(world.state(id).velocity.x == doctest::Approx(speed).epsilon(0.01));
                    CHECK(highest < 0.005);
                }
    }

    // The side of the next tile held it: it slid by .3 m in place of 2.25, or not at all where something
    // pushed or gravity drew it from rest.
    TEST_CASE_TEMPLATE("a crate that stands on a tile up to its edge slides on", Real, float, double) {
        constexpr double kFriction = 0.2, kSpeed = 3;
        for (const char* kind : {"boxes", "segments", "pieces of one body"})
            for (const double tilt : {0.0, 3.0})  // m/s², along the tiles
                for (const int rest : {0, 60}) {  // steps, before it is thrown
                    Scene scene = tiled(kind, 40);
                    scene.gravity.x = tilt;
                    for (Body& body : scene.bodies) {
                        body.material.friction = kFriction;
                        if (auto* pieces = std::get_if<Compound>(&body.shape))
                            for (Piece& piece : pieces->pieces) piece.material = body.material;
                    }
                    Body crate = smooth(Box{1, 1}, {1, 0.5});
                    crate.material.friction = kFriction;
                    const BodyId id = scene.add(crate);
                    BasicWorld<Real> world(scene);
                    for (int i = 0; i < (tilt > 0 ? 0 : rest); ++i) world.step(kStep);
                    if (tilt == 0) world.set_velocity(id, {kSpeed, 0});
                    for (int i = 0; i < 180; ++i) world.step(kStep);
                    const double way = tilt > 0 ? 0.5 * (tilt - kFriction * kGravity) * 9
                                                : 0.5 * kSpeed * kSpeed / (kFriction * kGravity);
                    INFO(kind, ", tilt ", tilt, ", rest ", rest);
                    CHECK(world.state(id).position.x - 1 == doctest::Approx(way).epsilon(0.01));
                    CHECK(std::fabs(world.state(id).angle) < 1e-3);
                }
    }

    // Corners of the columns on either side held it for ever.
    TEST_CASE_TEMPLATE("a column between columns comes down when its lowest box is gone", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -kGravity};
        scene.add(smooth(Box{100, 2}, {0, -1}, BodyType::static_body));
        for (const double x : {-0.5, 5.5}) scene.add(smooth(Box{1, 20}, {x, 10}, BodyType::static_body));
        BodyId lowest{}, highest{};
        for (int row = 0; row < 5; ++row)
            for (int column = 0; column < 5; ++column) {
                const BodyId id = scene.add(smooth(Box{1, 1}, {column + 0.5, row + 0.5}));
                if (column == 2 && row == 0) lowest = id;
                if (column == 2 && row == 4) highest = id;
            }
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        world.remove(lowest);
        for (int i = 0; i < 180; ++i) world.step(kStep);
        CHECK(std::fabs(world.state(highest).position.y - 3.5) < 0.05);
    }

    TEST_CASE_TEMPLATE("boxes that come corner to corner strike each other", Real, float, double) {
        for (const double speed : {1.0, 3.0, 10.0}) {
            Scene scene;
            scene.accuracy.solver = Solver::soft;
            for (const double side : {-1.0, 1.0}) {
                Body box = smooth(Box{1, 1}, {0.75 * side, 0.75 * side});
                box.velocity = {-0.5 * side * speed, -0.5 * side * speed};
                scene.add(box);
            }
            BasicWorld<Real> world(scene);
            double deepest = 0;
            for (double time = 0; time < 2 / speed; time += kStep)
                world.step(kStep), deepest = std::fmax(deepest, world.overlaps().max);
            INFO(speed, " m/s");
            CHECK(deepest < 0.2);
            CHECK(world.ledger().energy.kinetic < 0.7 * (0.5 * speed * speed));  // of that at the start
        }
    }

    TEST_CASE("a car rolls over tiles as over one slab") {
        Scene scene = tiled("boxes", 40);
        for (Body& body : scene.bodies) body.material.friction = 0.8;
        const Material rubber{.friction = 0.8};
        const BodyId chassis =
            scene.add({.shape = Box{1.6, 0.3}, .position = {2, 0.6}, .velocity = {6, 0}, .material = rubber});
        for (const double x : {1.4, 2.6}) {
            const BodyId wheel = scene.add({.shape = Disc{0.3},
                                            .position = {x, 0.3},
                                            .velocity = {6, 0},
                                            .angular_velocity = -6 / 0.3,
                                            .material = rubber});
            scene.add(Joint{.a = chassis, .b = wheel, .kind = RevoluteJoint{}});
        }
        World world(scene);
        for (int i = 0; i < 300; ++i) world.step(kStep);
        CHECK(world.state(chassis).velocity.x == doctest::Approx(6).epsilon(0.01));
    }

    // A player that a game gives a velocity into the wall in every step was held by the side of the next tile
    // below, behind the face of this one: a box stood on it for good.
    TEST_CASE_TEMPLATE("what is pressed on a wall of tiles falls freely", Real, float, double) {
        constexpr double kFall = 1.5;  // s
        for (const char* kind : {"boxes", "segments"})
            for (const double push : {1.0, 5.0})
                for (const Shape& shape :
                     {Shape{Box{0.6, 1.6}}, Shape{Capsule{1, 0.3}}, Shape{Box{0.6, 0.6}}}) {
                    Scene scene;
                    scene.gravity = {0, -kGravity};
                    for (int i = -3; i < 40; ++i) {
                        const double y = -i;
                        const BodyType fixed = BodyType::static_body;
                        if (kind == std::string("boxes"))
                            scene.add(smooth(Box{1, 1}, {1.1, y}, fixed));
                        else
                            scene.add(smooth(Segment{{0.6, 0.5}, {0.6, -0.5}}, {0, y}, fixed));
                    }
                    Body player = smooth(shape, {0.29, 0.2});
                    player.fixed_rotation = true;
                    if (std::holds_alternative<Capsule>(shape)) player.angle = 0.5 * std::numbers::pi;
                    const BodyId id = scene.add(player);
                    BasicWorld<Real> world(scene);
                    for (int i = 0; i < 90; ++i) {
                        world.set_velocity(id, {push, world.state(id).velocity.y});
                        world.step(kStep);
                    }
                    INFO(std::string(kind), ", pressed at ", push, " m/s");
                    CHECK(world.state(id).velocity.y == doctest::Approx(-kGravity * kFall).epsilon(0.02));
                    CHECK(world.state(id).position.x < 0.301);
                }
    }

    TEST_CASE_TEMPLATE("what is pressed on a floor of tiles runs over it", Real, float, double) {
        for (const char* kind : {"boxes", "segments", "pieces of one body"})
            for (const double push : {2.0, 5.0})
                for (const double step : {1.0 / 60, 1.0 / 120})
                    for (const Shape& shape : {Shape{Box{0.6, 1.6}}, Shape{Capsule{1, 0.3}}}) {
                        Scene scene = tiled(kind, 40);
                        const bool is_capsule = std::holds_alternative<Capsule>(shape);
                        Body player = smooth(shape, {1, 0.8});
                        player.fixed_rotation = true;
                        if (is_capsule) player.angle = 0.5 * std::numbers::pi;
                        const BodyId id = scene.add(player);
                        BasicWorld<Real> world(scene);
                        for (int i = 0; i < 5 / step; ++i) {
                            world.set_velocity(id, {5, -push});
                            world.step(step);
                        }
                        INFO(std::string(kind), ", pressed at ", push, " m/s, steps of ", step, " s");
                        CHECK(world.state(id).position.x == doctest::Approx(26).epsilon(0.001));
                    }
    }

    TEST_CASE_TEMPLATE("what is thrown onto tiles slides on", Real, float, double) {
        for (const double size : {1.0, 0.4})
            for (const double fall : {1.0, 3.0, 8.0}) {
                std::mt19937 random(1);
                std::uniform_real_distribution<double> uniform(0, 1);
                const int throws = scaled(100, 50);
                int slowed = 0, stopped = 0;
                for (int i = 0; i < throws; ++i) {
                    Scene scene = tiled("boxes", 30);
                    const double x = 2 + uniform(random), y = size / 2 + 0.02 + 0.3 * uniform(random);
                    Body box = smooth(Box{size, size}, {x, y});
                    box.velocity = {6, -fall}, box.fixed_rotation = true;
                    const BodyId id = scene.add(box);
                    BasicWorld<Real> world(scene);
                    for (int k = 0; k < 60; ++k) world.step(kStep);
                    slowed += world.state(id).velocity.x < 0.95 * 6;
                    stopped += world.state(id).velocity.x < 0.1 * 6;
                }
                report("boxes of ", size, " m thrown down at ", fall, " m/s: ", slowed, " of ", throws,
                       " slowed");
                CHECK(50 * slowed <= throws);  // 2 to 12 of 100 were, and half of those stood still
                CHECK(stopped == 0);
            }
    }
}

}  // namespace test_passing_shapes

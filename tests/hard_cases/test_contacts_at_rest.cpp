// Contacts of bodies that hardly move are carried on from step to step
// (docs/decisions/0035-contacts-at-rest.md): what they have come since must not be lost, and no body may be
// held by a contact that is gone.
#include "support/box_scenes.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/rms_speed.hpp"

#include <carom/generators.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

namespace test_contacts_at_rest {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s

template <class Real>
void run(BasicWorld<Real>& world, int steps) {
    for (int i = 0; i < steps; ++i) world.step(kStep);
}

/// Boxes of all sizes and turns, which fall into an open box as a heap; those of an odd number are capsules
/// if it is mixed.
Scene falling_heap(bool is_mixed, std::uint64_t seed) {
    constexpr std::uint64_t kBodies = 300;
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    scene.walls = Walls{{0, 0}, {16, 1000}};
    scene.walls->top = false;
    scene.walls->material.friction = 0.5;
    for (std::uint64_t i = 0; i < kBodies; ++i) {
        const auto random = [&](std::uint64_t k) { return jitter_of(seed + 4 * i + k); };
        const double width = 0.8 + 0.3 * random(0), height = 0.8 + 0.3 * random(1);
        Body body = box_at(1.5 + static_cast<double>(i % 10) * 1.4 + 0.1 * random(3),
                           1.5 + static_cast<double>(i / 10) * 1.4, width, height, 0.5, 3 * random(2));
        if (is_mixed && i % 2 == 1) body.shape = Capsule{width, 0.3 * height};
        scene.add(body);
    }
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/contacts at rest") {
    TEST_CASE_TEMPLATE("a stack that rides on a plate turns with it", Real, float, double) {
        // 0.5 mrad/s: the boxes turn by less in a step than makes their contacts be found again.
        constexpr double kTurn = 5e-4;
        constexpr int kSteps = 2400;
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        scene.add({.type = BodyType::kinematic_body,
                   .shape = Box{10, 2},
                   .position = {0, -1},
                   .angular_velocity = kTurn,
                   .material = {.friction = 0.8}});
        for (int i = 0; i < 4; ++i) scene.add(box_at(0, 0.5 + i, 1, 1, 0.8));
        BasicWorld<Real> world(scene);
        run(world, kSteps);
        const double angle = world.state({0, 0}).angle;
        CHECK(angle == doctest::Approx(kTurn * kStep * kSteps).epsilon(1e-3));
        for (std::uint32_t i = 1; i < 4; ++i) {
            const BodyState low = world.state({i, 0}), high = world.state({i + 1, 0});
            const double dx = high.position.x - low.position.x, dy = high.position.y - low.position.y;
            const double along = dx * std::cos(angle) + dy * std::sin(angle),
                         up = dy * std::cos(angle) - dx * std::sin(angle);
            CHECK(std::abs(along) < 1e-3);
            CHECK(std::abs(up - 1) < 1e-3);
            CHECK(std::abs(high.angle - angle) < 2e-4);
        }
    }
    TEST_CASE_TEMPLATE("a box that is pushed slowly keeps on the ground and at the pusher", Real, float,
                       double) {
        constexpr double kSpeed = 1e-3;  // m/s: 17 um a step
        Scene scene = box_ground(0.5);
        scene.add(box_at(0, 0.5, 1, 1, 0.5));
        scene.add(box_at(0, 1.5, 1, 1, 0.5));
        scene.add({.type = BodyType::kinematic_body,
                   .shape = Box{1, 0.5},
                   .position = {-1, 0.5},
                   .velocity = {kSpeed, 0}});
        BasicWorld<Real> world(scene);
        run(world, 1800);
        for (const std::uint32_t box : {1u, 2u}) {
            CHECK(std::abs(world.state({box, 0}).position.x - 30 * kSpeed) < 5e-4);
            CHECK(std::abs(world.state({box, 0}).position.y - (box - 0.5)) < 1e-3);
        }
        CHECK(world.overlaps().max < 2e-3);
    }
    TEST_CASE_TEMPLATE("a heap that has fallen comes to rest, and lies still", Real, float, double) {
        // docs/decisions/0037-heaps-that-lie-still.md: such heaps crept by 6e-4 m in 100 steps.
        for (const bool is_mixed : {false, true}) {
            const Scene scene = falling_heap(is_mixed, 7);
            BasicWorld<Real> world(scene);
            run(world, scaled(1500, 900));
            const auto bodies = static_cast<std::uint32_t>(scene.bodies.size());
            std::vector<Vec2> from;
            for (std::uint32_t i = 0; i < bodies; ++i) from.push_back(world.state({i, 0}).position);
            run(world, 100);
            double way = 0;
            for (std::uint32_t i = 0; i < bodies; ++i) {
                const Vec2 at = world.state({i, 0}).position;
                way += std::hypot(at.x - from[i].x, at.y - from[i].y) / bodies;
            }
            report("way of a body of a heap in 100 steps, mean: ", way, " m");
            CHECK(way < 1e-4);
            CHECK(rms_speed(world) < 2e-4);
            CHECK(world.overlaps().max < 0.03);
            CHECK(world.overlaps().mean < 0.006);
        }
    }
    TEST_CASE_TEMPLATE("what stood on a box that is taken away falls freely at once", Real, float, double) {
        Scene scene = box_ground(0.5);
        scene.add(box_at(0, 0.5, 1, 1, 0.5));
        scene.add(box_at(0, 1.5, 1, 1, 0.5));
        BasicWorld<Real> world(scene);
        run(world, 240);
        const double start = world.state({2, 0}).position.y;
        SUBCASE("put elsewhere") {
            world.set_position({1, 0}, {5, 0.5});
        }
        SUBCASE("removed") {
            world.remove({1, 0});
        }
        run(world, 12);
        const double fallen = 0.5 * kBoxGravity * 0.2 * 0.2;
        CHECK(start - world.state({2, 0}).position.y == doctest::Approx(fallen).epsilon(0.02));
    }
    TEST_CASE_TEMPLATE("a body that comes where pieces of compounds were has a pose of its own", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        scene.accuracy.solver = Solver::soft;
        scene.walls = Walls{{-5, -1}, {5, 20}};
        scene.add({.shape = Compound{{{.shape = Box{1, 0.2}}, {.shape = Disc{0.2}, .position = {0.6, 0}}}},
                   .angle = 0.8});
        scene.add({.shape = Box{0.5, 0.5}, .position = {0, 0.4}});
        BasicWorld<Real> world(scene);
        run(world, 1);
        world.add({.shape = Box{3, 0.1}, .position = {0, 0.75}});
        BasicWorld<Real> copy(world);
        run(world, 1), run(copy, 1);
        CHECK(world.state_hash() == copy.state_hash());
    }
    TEST_CASE_TEMPLATE("far from the origin a pyramid rests as near it", Real, float, double) {
        // Positions are rounded to 6e-5 m there in single precision.
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        scene.add({.type = BodyType::static_body,
                   .shape = Box{40, 2},
                   .position = {1000, -1},
                   .material = {.friction = 0.6}});
        add_pyramid(
            scene,
            {.base = 10, .origin = {995, 0.5}, .body = {.shape = Box{1, 1}, .material = {.friction = 0.6}}});
        BasicWorld<Real> world(scene);
        run(world, 900);
        report("rms speed at x = 1 km: ", rms_speed(world), " m/s");
        CHECK(rms_speed(world) < 0.02);
        CHECK(world.overlaps().max < 0.01);
    }
}

}  // namespace test_contacts_at_rest

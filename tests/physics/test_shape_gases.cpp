// A14 of docs/exact-cases.md for many bodies: elastic, smooth gases of shapes, where each impact has its
// formula and all of them together keep the energy.
#include "support/box_scenes.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace test_shape_gases {

using namespace carom;
using namespace carom::test;

namespace {

const Shape kDisc = Disc{0.3}, kBox = Box{0.6, 0.5}, kCapsule = Capsule{0.5, 0.2},
            kTriangle = Polygon{{{-0.35, -0.3}, {0.35, -0.3}, {0, 0.4}}};

constexpr int kSide = 12;  // bodies

/// Bodies of some shapes in a square with elastic walls. @param spacing  m
Scene shape_gas(const std::vector<Shape>& shapes, double spacing, int number) {
    Scene scene;
    scene.walls = Walls{.min = {-spacing, -spacing}, .max = {kSide * spacing, kSide * spacing}};
    scene.walls->material.restitution = 1;
    for (int i = 0; i < kSide * kSide; ++i) {
        const auto some = [&](int which) {
            return jitter_of(static_cast<std::uint64_t>(1000 * number + 4 * i + which));
        };
        Body body{.position = {spacing * (i % kSide), spacing * (i / kSide)},
                  .angle = 3 * some(0),
                  .velocity = {3 * some(1), 3 * some(2)},
                  .angular_velocity = 2 * some(3),
                  .material = {.restitution = 1}};
        body.shape = shapes[static_cast<std::size_t>(i) % shapes.size()];
        scene.add(body);
    }
    return scene;
}

}  // namespace

TEST_SUITE("physics/shape gases") {
    TEST_CASE_TEMPLATE("A14: an elastic gas of discs and other shapes keeps its energy", Real, float,
                       double) {
        double worst = 0;
        for (const auto& shapes : {std::vector{kDisc, kBox, kCapsule, kTriangle}, std::vector{kCapsule}})
            for (const double spacing : {0.95, 1.5})
                for (const double rate : {60.0, 120.0})
                    for (int number = 1; number < scaled(4, 2); ++number) {
                        CAPTURE(shapes.size());
                        CAPTURE(spacing);
                        CAPTURE(rate);
                        CAPTURE(number);
                        BasicWorld<Real> world(shape_gas(shapes, spacing, number));
                        const double start = world.ledger().energy.total();
                        for (int i = 0; i < 10 * rate; ++i) world.step(1 / rate);
                        const double off = std::fabs(world.ledger().energy.total() / start - 1);
                        worst = std::fmax(worst, off);
                        CHECK(off < (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12));
                    }
        report("A14: elastic gases of shapes are off by ", worst, " of their energy after 10 s");
    }
    TEST_CASE_TEMPLATE("A14: what is pushed out of an overlap bounces off a wall with all of its energy",
                       Real, float, double) {
        // The push takes the box to the wall a substep before its velocity does.
        double worst = 0;
        for (int number = 0; number < 40; ++number) {
            CAPTURE(number);
            Scene scene;
            scene.walls = Walls{.min = {-9, -9}, .max = {0.6 + 0.0002 * number, 9}};
            scene.walls->material.restitution = 1;
            scene.accuracy.solver = Solver::soft;
            for (const double side : {-1.0, 1.0})
                scene.add({.shape = Box{0.6, 0.5},
                           .position = {0.28 * side, 0},
                           .velocity = {5 * side, 0},
                           .material = {.restitution = 1}});
            BasicWorld<Real> world(scene);
            const double start = world.ledger().energy.total();
            for (int i = 0; i < 12; ++i) world.step(1 / 60.0);
            worst = std::fmax(worst, std::fabs(world.ledger().energy.total() / start - 1));
            CHECK(world.state({1, 0}).velocity.x < 0);
        }
        report("A14: boxes pushed towards a wall are off by ", worst, " of their energy");
        CHECK(worst < (sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14));
    }
}

}  // namespace test_shape_gases

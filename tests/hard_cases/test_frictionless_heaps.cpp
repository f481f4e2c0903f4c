// B33 of docs/hard-cases.md: heaps that no friction holds come to rest, and columns stand, with and without
// it.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/rms_speed.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace test_frictionless_heaps {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kGravity = 9.81, kRadius = 0.5;
constexpr double kLargestRms = 1e-3;  // m/s

/// Discs at fill 0.6 over the floor of a box twice as wide as they are high, let go.
Scene pile(std::int64_t discs, double smallest, double restitution) {
    const double mean_square = (smallest * smallest + smallest * kRadius + kRadius * kRadius) / 3;
    const double area = static_cast<double>(discs) * std::numbers::pi * mean_square / 0.6;
    const double width = std::sqrt(2 * area);
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls =
        Walls{.min = {0, 0}, .max = {width, area / width}, .top = false, .material = bouncy(restitution)};
    Gas gas;
    gas.count = discs, gas.radius = {smallest, kRadius}, gas.seed = 1;
    gas.body.material = bouncy(restitution);
    add_gas(scene, gas);
    scene.accuracy.solver = Solver::soft;
    return scene;
}

/// Boxes, or polygons of 3 to 8 vertices, that turn as they fall into a box, without friction.
Scene heap_of_shapes(int bodies, bool of_boxes, unsigned seed) {
    std::mt19937 random(seed);
    const auto draw = [&](double low, double high) {
        return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
    };
    const int columns = static_cast<int>(1.3 * std::sqrt(bodies));
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {0, 0}, .max = {1.03 * columns + 2, 200}};
    scene.effects.sleep = true;
    for (int i = 0; i < bodies; ++i) {
        Body body{.shape = Box{0.8, 0.6}};
        if (!of_boxes) {
            Polygon polygon;
            const int vertices = 3 + static_cast<int>(random() % 6);
            const double turn = draw(0, 6);
            for (int k = 0; k < vertices; ++k) {
                const double angle = turn + 2 * std::numbers::pi * k / vertices;
                polygon.vertices.push_back({0.45 * std::cos(angle), 0.45 * std::sin(angle)});
            }
            body.shape = polygon;
        }
        body.position = {1 + 1.03 * (i % columns), 3 + 1.03 * (i / columns)};
        body.angular_velocity = draw(-3, 3);
        scene.add(body);
    }
    return scene;
}

/// Discs that touch, one on another, the lowest so high above the floor.
Scene bare_column(int discs, double friction, double smallest, double height) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const Material material{.friction = friction};
    scene.walls = floor_at(0);
    scene.walls->material = material;
    double y = height;
    for (int i = 0; i < discs; ++i) {
        const double radius = smallest + (kRadius - smallest) * (i * 7 % 10) / 9.0;
        scene.add({.shape = Disc{radius}, .position = {0, y + radius}, .material = material});
        y += 2 * radius;
    }
    scene.accuracy.solver = Solver::soft;
    return scene;
}

/// @param shaft  m, between its sides; 0: there are none
Scene column(int discs, double shaft) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = floor_at(0);
    if (shaft > 0) scene.walls = Walls{.min = {-0.5 * shaft, 0}, .max = {0.5 * shaft, 1e3}, .top = false};
    const double aside = shaft > 0 ? 1e-3 : 0;
    for (int i = 0; i < discs; ++i)
        scene.add(disc(kRadius, 1, {i % 2 == 0 ? aside : -aside, kRadius * (2 * i + 1)}));
    scene.accuracy.solver = Solver::soft;
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/frictionless heaps") {
    TEST_CASE_TEMPLATE("B33: a frictionless pile of 1,000 comes to rest", Real, float, double) {
        for (const double smallest : {kRadius, 0.6 * kRadius}) {
            BasicWorld<Real> world(pile(scaled(1000, 300), smallest, 0), {.threads = 1});
            for (int i = 0; i < 1800; ++i) world.step(kStep);
            report("radii from ", smallest, ": rms ", rms_speed(world), " m/s, overlap ",
                   world.overlaps().max);
            CHECK(rms_speed(world) < kLargestRms);
            CHECK(world.overlaps().max < 0.01);
        }
    }

    TEST_CASE("B33: frictionless piles sleep") {
        for (const double restitution : {0.0, 0.5}) {
            const int count = scaled(1000, 300);
            Scene scene = pile(count, kRadius, restitution);
            scene.effects.sleep = true;
            World world(scene, {.threads = 1});
            for (int i = 0; i < 2400 && world.profile().asleep < count; ++i) world.step(kStep);
            CHECK(world.profile().asleep == count);
        }
    }

    // With contacts of the start of each step one such heap in eight sleeps.
    TEST_CASE("B33: heaps of smooth boxes and polygons that fell and turned sleep") {
        const int seeds = scaled(2, 1);
        int heaps = 0, asleep = 0;
        for (const int bodies : scaled<std::vector<int>>({600, 200}, {200}))
            for (int seed = 1; seed <= seeds; ++seed)
                for (const bool of_boxes : {true, false}) {
                    World world(heap_of_shapes(bodies, of_boxes, static_cast<unsigned>(seed)),
                                {.threads = 1});
                    int steps = 0;
                    while (steps < 3600 && world.profile().asleep < bodies) world.step(kStep), ++steps;
                    report(bodies, of_boxes ? " boxes" : " polygons", ", seed ", seed, ": ",
                           world.profile().asleep, " sleep after ", steps, " steps, overlap ",
                           world.overlaps().mean, ", ", world.overlaps().max);
                    ++heaps, asleep += world.profile().asleep == bodies;
                }
        CHECK(4 * asleep >= 3 * heaps);
    }

    TEST_CASE_TEMPLATE("B33: a column of 100 lies still after 20 s, alone and in a shaft", Real, float,
                       double) {
        for (const double shaft : {0.0, 1.05}) {
            BasicWorld<Real> world(column(100, shaft), {.threads = 1});
            double largest = 0;
            for (int i = 0; i < 1800; ++i) {
                world.step(kStep);
                if (i >= 1200) largest = std::fmax(largest, rms_speed(world));
            }
            report("shaft ", shaft, " m: rms ", largest, " m/s");
            CHECK(largest < kLargestRms);
        }
    }

    // Sweeps alone: 0.5 m/s without friction, 1.1 m/s for ever with it.
    TEST_CASE_TEMPLATE("B33: columns of touching discs stand from the start", Real, float, double) {
        for (const double friction : {0.0, 0.5})
            for (const double smallest : {kRadius, 0.6 * kRadius})
                for (const int discs : {10, 20, 100, 200}) {
                    CAPTURE(friction);
                    CAPTURE(smallest);
                    CAPTURE(discs);
                    BasicWorld<Real> world(bare_column(discs, friction, smallest, 0), {.threads = 1});
                    double largest = 0;
                    for (int i = 0; i < scaled(600, 120); ++i) {
                        world.step(kStep);
                        largest = std::fmax(largest, rms_speed(world));
                    }
                    report(discs, " discs of ", smallest, " m on, friction ", friction, ": rms ", largest);
                    CHECK(largest < kLargestRms);
                    CHECK(world.overlaps().max < 1e-3);
                }
    }

    TEST_CASE_TEMPLATE("B33: columns that are dropped stop at once, and gain no energy", Real, float,
                       double) {
        for (const double friction : {0.0, 0.5}) {
            CAPTURE(friction);
            Scene scene = bare_column(100, friction, 0.7 * kRadius, 5);
            scene.effects.ledger = true;
            BasicWorld<Real> world(scene, {.threads = 1});
            const double start = world.ledger().energy.total();
            for (int i = 0; i < 180; ++i) {
                world.step(kStep);
                CHECK(world.ledger().energy.total() < (1 + 1e-6) * start);
            }
            report("friction ", friction, ": rms ", rms_speed(world), " m/s, overlap ", world.overlaps().max);
            CHECK(rms_speed(world) < kLargestRms);
            CHECK(world.overlaps().max < 1e-3);
        }
    }

    // Without the correction of loads 0.1 to 0.8 m/s.
    TEST_CASE_TEMPLATE("B33: smooth discs poured into narrow shafts calm down within ten seconds", Real,
                       float, double) {
        for (const int width : scaled<std::vector<int>>({2, 3, 5}, {2, 3}))
            for (const double smallest : {kRadius, 0.6 * kRadius}) {
                CAPTURE(width);
                CAPTURE(smallest);
                Scene scene;
                scene.gravity = {0, -kGravity};
                scene.walls = Walls{.min = {0, 0}, .max = {2.04 * kRadius * width, 1e4}, .top = false};
                for (int i = 0; i < 100 * width; ++i) {
                    const double radius = smallest + (kRadius - smallest) * (i * 7 % 10) / 9.0,
                                 jitter = 0.008 * ((i * 13 % 11) / 10.0 - 0.5);
                    scene.add(disc(radius, 1,
                                   {1.01 * kRadius * (2 * (i % width) + 1) + jitter,
                                    1.01 * kRadius * (2 * (i / width) + 1)}));
                }
                scene.accuracy.solver = Solver::soft;
                BasicWorld<Real> world(scene, {.threads = 1});
                double late = 0;
                for (int i = 0; i < 600; ++i) {
                    world.step(kStep);
                    if (i >= 540) late = std::fmax(late, rms_speed(world));
                }
                report(width, " wide, from ", smallest, " m: rms ", late, " m/s");
                CHECK(late < 0.05);
            }
    }

    TEST_CASE("a world says how many sweeps its frictionless heaps get, and takes those that are asked for") {
        CHECK(World(column(64, 0)).plan().iterations == 5);
        CHECK(World(column(3, 0)).plan().iterations == 2);
        CHECK(World(column(3, 0), {.iterations = 2}).plan().iterations == 2);
        Scene rough = column(3, 0);
        for (Body& body : rough.bodies) body.material.friction = 0.1;
        CHECK(World(rough).plan().iterations == 2);
    }
}

}  // namespace test_frictionless_heaps

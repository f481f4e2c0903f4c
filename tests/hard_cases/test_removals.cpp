// B24 of docs/hard-cases.md: what is left when a weight or a support is taken out of a pile that is awake.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace test_removals {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kGravity = 10, kRadius = 0.5;

struct Motion {
    double fastest = 0, upwards = 0, rms = 0;  // m/s
};

template <class Real>
Motion motion_of(const BasicWorld<Real>& world) {
    const BodyView<Real> bodies = world.bodies();
    Motion motion;
    double sum = 0;
    for (std::size_t i = 0; i < bodies.count; ++i) {
        const double x = bodies.velocity_x[i], y = bodies.velocity_y[i];
        motion.fastest = std::fmax(motion.fastest, std::hypot(x, y));
        motion.upwards = std::fmax(motion.upwards, y);
        sum += x * x + y * y;
    }
    motion.rms = std::sqrt(sum / static_cast<double>(bodies.count));
    return motion;
}

/// Discs of 1 kg on each other between two walls, and one of another mass on top.
Scene stack(int discs, double weight, double friction) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {0, 0}, .max = {2.002 * kRadius, 1000}, .top = false};
    scene.walls->material.friction = friction;
    scene.accuracy.solver = Solver::soft;
    for (int i = 0; i <= discs; ++i) {
        scene.add(disc(kRadius, i < discs ? 1 : weight, {kRadius, kRadius + i}));
        scene.bodies.back().material.friction = friction;
    }
    return scene;
}

/// Rough discs in rows between two walls.
Scene pile(int columns, int rows) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const Material rough{.friction = 0.5};
    scene.walls = Walls{.min = {0, 0}, .max = {1.05 * columns, 1000}, .top = false, .material = rough};
    scene.accuracy.solver = Solver::soft;
    Lattice lattice;
    lattice.count_x = columns - 1, lattice.count_y = rows;
    lattice.origin = {0.55, 0.51}, lattice.spacing = {1.035, 0.9};
    lattice.stagger = true, lattice.jitter = 0.005;
    lattice.body = {.shape = Disc{kRadius}, .material = rough};
    add_lattice(scene, lattice);
    return scene;
}

/// Boxes of 0.5 to 0.8 m, at any angle, of 1 kg each, over a floor between two walls.
Scene boxes_that_fall(int count) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    const Material rough{.friction = 0.5};
    scene.walls = Walls{.min = {0, 0}, .max = {16, 1000}, .top = false, .material = rough};
    std::mt19937_64 random(3);
    std::uniform_real_distribution<double> side(0.5, 0.8), angle(0, 6);
    for (int i = 0; i < count; ++i)
        scene.add({.shape = Box{side(random), side(random)},
                   .position = {0.6 + 0.9 * (i % 17), 0.6 + 0.9 * (i / 17)},
                   .angle = angle(random),
                   .mass = 1,
                   .material = rough});
    return scene;
}

template <class Real>
void run(BasicWorld<Real>& world, int steps) {
    for (int i = 0; i < steps; ++i) world.step(kStep);
}

/// Steps until nothing has been faster than 0.01 m/s for a second: a pile of discs that roll can stand for
/// seconds and then give way, so a number of steps proves nothing.
/// @return whether that came within a minute
template <class Real>
bool comes_to_rest(BasicWorld<Real>& world) {
    int quiet_steps = 0;
    for (int i = 0; i < 3600 && quiet_steps < 60; ++i) {
        world.step(kStep);
        quiet_steps = motion_of(world).fastest < 0.01 ? quiet_steps + 1 : 0;
    }
    return quiet_steps == 60;
}

}  // namespace

TEST_SUITE("hard cases/removals") {
    TEST_CASE_TEMPLATE("B24: a 100-fold weight that is removed leaves the stack below it at rest", Real,
                       float, double) {
        for (const double friction : {0.0, 0.5})
            for (const int discs : {3, 8, 20})
                for (const double weight : {10.0, 100.0}) {
                    BasicWorld<Real> world(stack(discs, weight, friction), {.threads = 1});
                    run(world, 1200);
                    world.remove({static_cast<std::uint32_t>(discs), 0});
                    double fastest = 0;
                    for (int i = 0; i < 60; ++i) {
                        world.step(kStep);
                        fastest = std::fmax(fastest, motion_of(world).fastest);
                    }
                    report(discs, " discs, a weight of ", weight, " removed: at most ", fastest, " m/s");
                    CHECK(fastest < 0.1);
                }
    }

    TEST_CASE_TEMPLATE("B24: a weight that leant on a static disc, too, leaves the stack below it at rest",
                       Real, float, double) {
        for (const int discs : {3, 8, 20})
            for (const double weight : {10.0, 100.0}) {
                Scene scene = stack(discs, weight, 0);
                scene.walls->right = false;
                const double top = discs - kRadius;
                scene.add(
                    {.type = BodyType::static_body, .shape = Segment{{1.001, 0}, {1.001, discs - 0.4}}});
                scene.add({.type = BodyType::static_body,
                           .shape = Disc{kRadius},
                           .position = {kRadius + 1.5, top}});
                const auto removed = static_cast<std::uint32_t>(discs);
                scene.bodies[removed].position = {kRadius + 0.75, top + std::sqrt(1 - 0.75 * 0.75)};
                BasicWorld<Real> world(scene, {.threads = 1});
                run(world, 1200);
                CHECK(world.state({removed, 0}).position.y > top + 0.5);
                world.remove({removed, 0});
                double fastest = 0;
                for (int i = 0; i < 60; ++i) {
                    world.step(kStep);
                    fastest = std::fmax(fastest, motion_of(world).fastest);
                }
                report(discs, " discs, a weight of ", weight, " removed: at most ", fastest, " m/s");
                CHECK(fastest < 0.1);
            }
    }

    TEST_CASE_TEMPLATE("B24: what stood on a base that is removed falls freely", Real, float, double) {
        for (const int discs : {3, 8})
            for (const double weight : {1.0, 100.0}) {
                BasicWorld<Real> world(stack(discs, weight, 0), {.threads = 1});
                run(world, 1200);
                world.remove({0, 0});
                world.step(kStep);
                double off = 0;
                for (std::uint32_t body = 1; body <= static_cast<std::uint32_t>(discs); ++body)
                    off = std::fmax(off, std::fabs(world.state({body, 0}).velocity.y + kGravity * kStep));
                report(discs, " discs under a weight of ", weight, ": off free fall by ", off, " m/s");
                CHECK(off < 0.1);
            }
    }

    // What a weight had pressed into the pile may fall or roll into the hole it leaves, but none is thrown.
    TEST_CASE_TEMPLATE("B24: no disc is thrown when a weight is taken off a pile", Real, float, double) {
        for (const double radius : {kRadius, 5 * kRadius}) {
            Scene scene = pile(20, 20);
            const double top = 0.51 + 0.9 * 19 + kRadius;
            const BodyId weight =
                scene.add(disc(radius, 100 * 3.14159265 * kRadius * kRadius, {10, top + radius + 0.1}));
            BasicWorld<Real> world(scene, {.threads = 1});
            REQUIRE(comes_to_rest(world));
            world.remove(weight);
            double upwards = 0;
            for (int i = 0; i < 3; ++i) {
                world.step(kStep);
                upwards = std::fmax(upwards, motion_of(world).upwards);
            }
            report("a weight of radius ", radius, " taken off a pile: upwards at most ", upwards, " m/s");
            CHECK(upwards < 0.1);
        }
    }

    // With the impulses of the step before boxes were thrown upwards by 0.1 to 0.9 m/s.
    TEST_CASE_TEMPLATE("B24: no box is thrown when a weight is taken off a heap of boxes", Real, float,
                       double) {
        BasicWorld<Real> heap(boxes_that_fall(150), {.threads = 1});
        run(heap, 400);
        for (const double width : {1.0, 3.0}) {
            BasicWorld<Real> loaded(heap);
            const BodyId weight = loaded.add({.shape = Box{width, width},
                                              .position = {8, 10},
                                              .mass = 100,
                                              .material = {.friction = 0.5}});
            run(loaded, 600);
            for (const bool is_moved : {false, true}) {
                BasicWorld<Real> world(loaded);
                if (is_moved)
                    world.set_position(weight, {8, 500});
                else
                    world.remove(weight);
                double upwards = 0;
                for (int i = 0; i < 3; ++i) {
                    world.step(kStep);
                    upwards = std::fmax(upwards, motion_of(world).upwards);
                }
                report("a weight of 100, ", width, " m wide, ", is_moved ? "moved" : "removed",
                       ": upwards at most ", upwards, " m/s in three steps");
                CHECK(upwards < 0.1);
            }
        }
    }

    TEST_CASE_TEMPLATE("B24: a body that goes in every step does not jolt the pile it was in", Real, float,
                       double) {
        // What falls into the holes is chance, 0.03 to 0.13 m/s: so several times. A smaller pile would move
        // more on the whole, so its size is not scaled.
        double sum = 0;
        const int steps = scaled(60, 20);
        constexpr int kPiles = 4;
        BasicWorld<Real> at_rest(pile(50, 50), {.threads = 1});
        run(at_rest, scaled(1000, 600));
        for (int seed = 0; seed < kPiles; ++seed) {
            BasicWorld<Real> world(at_rest);
            std::mt19937 random(static_cast<unsigned>(seed));
            for (int i = 0; i < steps; ++i) {
                const BodyView<Real> bodies = world.bodies();
                world.remove(bodies.id[random() % bodies.count]);
                world.step(kStep);
                const double rms = motion_of(world).rms;
                sum += rms * rms;
            }
            CHECK(world.quarantined().empty());
        }
        const double rms = std::sqrt(sum / (kPiles * steps));
        report("rms speed while bodies go: ", rms, " m/s");
        CHECK(rms < 0.1);
    }
}

}  // namespace test_removals

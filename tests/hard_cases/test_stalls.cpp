// No step stalls: what a step solves is bounded by its bodies and contacts, whatever these do.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "math/random.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Discs and capsules that fall into a box, half of them at random 1,000 times heavier, that resist rolling.
Scene heap_of_uneven_rollers(int count, double rolling) {
    Random random(7);
    const auto draw = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.next() % 1000003) / 1000003.0;
    };
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {10, 1000}, .material = {.friction = 0.5}};
    for (int i = 0; i < count; ++i) {
        Body body{.position = {0.6 + i % 9 * 1.1, 0.6 + i / 9 * 1.1},
                  .angle = draw(0, std::numbers::pi),
                  .material = {.friction = 0.5, .rolling_resistance = rolling}};
        if (draw(0, 1) < 0.5)
            body.shape = Disc{0.45};
        else
            body.shape = Capsule{0.4, 0.25};
        body.material.density = draw(0, 1) < 0.5 ? 1 : 1000;
        scene.add(body);
    }
    return scene;
}

/// A bar on a hinge of the world, which a motor turns among boxes that have fallen around it.
Scene stirred_boxes() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {-8, -8}, .max = {8, 100}, .material = {.friction = 0.1}};
    const BodyId bar = scene.add({.shape = Box{0.6, 14}, .material = {.density = 5}});
    scene.add(
        Joint{.b = bar, .kind = RevoluteJoint{.anchor = Vec2{}, .motor_speed = 3, .max_motor_torque = 1e5}});
    for (int i = 0; i < 900; ++i) {
        const double side = i % 2 == 0 ? -1 : 1;
        scene.add({.shape = Box{0.35, 0.35},
                   .position = {side * (0.6 + 0.45 * (i / 2 % 16)), -7.7 + 0.45 * (i / 32)},
                   .material = {.density = 0.25, .friction = 0.1}});
    }
    return scene;
}

/// The most solves of contacts of shapes in a step.
template <class Number>
std::int64_t most_solves(const Scene& scene, int steps) {
    BasicWorld<Number> world(scene, {.threads = 1});
    std::int64_t most = 0;
    for (int step = 0; step < steps; ++step) {
        const std::int64_t before = world.profile().path_solves;
        world.step(kStep);
        most = std::max(most, world.profile().path_solves - before);
    }
    return most;
}

}  // namespace

TEST_SUITE("hard cases/stalls") {
    // A substep solves paths once, and up to five times more where the world has gained energy; each is four
    // solves with rolling resistance. The turns of what is uneven are 31 in a substep and 124 in a step at
    // most, but for rounding, a solve each: docs/decisions/0086-steps-that-stall.md. They were seven.
    TEST_CASE_TEMPLATE("a heap of uneven masses that roll solves its contacts a bounded number of times",
                       Number, float, double) {
        constexpr int kTurns = 124;
        for (const double rolling : {0.0, 0.3})
            for (const int substeps : {4, 30}) {
                Scene scene = heap_of_uneven_rollers(72, rolling);
                scene.accuracy.substeps = substeps;
                const std::int64_t most = most_solves<Number>(scene, scaled(150, 60));
                report("rolling resistance ", rolling, ", ", substeps, " substeps: at most ", most,
                       " solves in a step");
                CHECK(most <= 6 * substeps * (rolling > 0 ? 4 : 1) + kTurns + substeps);
            }
    }

    // Contacts were solved up to four times more in turns with the joint, and three times without:
    // docs/decisions/0091-wild-and-restless-crowds.md. What is bounded in energy is solved once more.
    TEST_CASE("a motor that stirs a crowd of shapes has its contacts solved about once a substep") {
        World world(stirred_boxes(), {.threads = 1});
        for (int step = 0; step < 60; ++step) world.step(kStep);
        constexpr int kSteps = 60;
        const Profile then = world.profile();
        double hinge = 0;  // m, the largest error
        for (int step = 0; step < kSteps; ++step) {
            world.step(kStep);
            hinge = std::max(hinge, world.joint_errors().max);
        }
        const Profile profile = world.profile();
        const auto substeps = static_cast<std::int64_t>(kSteps * world.plan().substeps);
        const std::int64_t solves = profile.path_solves - then.path_solves;
        report("a stirred crowd: ", solves, " solves in ", substeps, " substeps, ", profile.contacts,
               " contacts, hinge off by ", hinge, " m, overlap ", world.overlaps().mean, " in the mean");
        CHECK(profile.contacts > 1024);
        CHECK(solves < substeps + substeps / 2);
        CHECK(hinge < 1e-3);
        CHECK(world.overlaps().mean < 0.1);
    }
}

// Mechanisms that lie on heaps: docs/decisions/0098-turns-around-what-is-restless.md.
#include "support/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr Material kBrick{.friction = 0.6};
constexpr int kCourses = 26, kBricks = 41, kLinks = 12;

/// A wall of bricks of 1 m on which a rope of capsules lies, a metre above at first, its end on the world.
Scene rope_on_wall() {
    Scene scene;
    scene.gravity = {0, -9.81};
    scene.walls = Walls{.min = {-60, 0}, .max = {60, 60}, .top = false, .material = kBrick};
    for (int course = 0; course < kCourses; ++course)
        for (int k = 0; k < kBricks; ++k)
            scene.add({.shape = Box{1, 1},
                       .position = {-20 + 1.001 * k + 0.5 * (course % 2), 0.5 + course},
                       .material = kBrick});
    std::optional<BodyId> last;
    const double y = kCourses + 1;
    for (int i = 0; i < kLinks; ++i) {
        const BodyId link =
            scene.add({.shape = Capsule{0.8, 0.1}, .position = {-5.5 + i, y}, .material = kBrick});
        scene.add(Joint{.a = last, .b = link, .kind = RevoluteJoint{.anchor = Vec2{-6.0 + i, y}}});
        last = link;
    }
    return scene;
}

}  // namespace

TEST_SUITE("hard cases: mechanisms on heaps") {
    // Four turns of joints and contacts a substep solved all 3,000 contacts of the wall, where the rope has
    // some twenty: 11 solves a step in place of four.
    TEST_CASE("a rope on a wall has contacts near it solved in turns, not the wall") {
        World world(rope_on_wall());
        for (int i = 0; i < 120; ++i) world.step(kStep);
        const std::int64_t before = world.profile().path_solves;
        constexpr int kSteps = 120;
        double open = 0;
        for (int i = 0; i < kSteps; ++i) {
            world.step(kStep);
            open = std::max(open, world.joint_errors().max);
        }
        const double solves = static_cast<double>(world.profile().path_solves - before) / kSteps;
        const double overlap = world.overlaps().max;
        report("rope on a wall: ", solves, " solves a step, hinges open by ", open, " m, overlap ", overlap,
               " inradii");
        CHECK(world.profile().contacts > 2000);
        CHECK(solves < world.plan().substeps + 1);
        CHECK(open < 1e-3);
        CHECK(overlap < 0.02);
    }
}

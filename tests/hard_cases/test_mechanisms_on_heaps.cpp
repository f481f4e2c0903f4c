// Mechanisms that lie on heaps: docs/decisions/0098-turns-around-what-is-restless.md.
#include "solvers/soft/soft_simulation.hpp"
#include "stages/stage_observer.hpp"
#include "support/inside.hpp"
#include "support/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

namespace test_mechanisms_on_heaps {

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

/// A car that drives on the floor, and a heap of boxes far from it that falls together.
Scene car_and_heap() {
    Scene scene;
    scene.gravity = {0, -9.81};
    scene.walls = Walls{.min = {-60, 0}, .max = {60, 60}, .top = false, .material = kBrick};
    const BodyId hull =
        scene.add({.shape = Box{3, 0.8}, .position = {-40, 0.9}, .material = {.friction = 0.4}});
    for (const double side : {-1.1, 1.1}) {
        const Vec2 at{-40 + side, 0.5};
        const BodyId wheel = scene.add({.shape = Disc{0.5}, .position = at, .material = kBrick});
        scene.add(Joint{.a = hull,
                        .b = wheel,
                        .kind = RevoluteJoint{.anchor = at, .motor_speed = -6, .max_motor_torque = 8}});
    }
    for (int i = 0; i < 30; ++i)
        scene.add({.shape = Box{0.9, 0.5},
                   .position = {30 + 1.1 * (i % 5) + 0.2 * (i / 5), 0.5 + 0.9 * (i / 5)},
                   .angle = 0.3 * i,
                   .material = kBrick});
    return scene;
}

/// Counts the runs of a stage, and those in which the velocity of a body from `first` on changes.
class ChangesOfStage final : public StageObserver {
  public:
    ChangesOfStage(SoftSimulation<float>& sim, std::string_view name, std::size_t first)
        : sim_(sim), first_(first) {
        std::size_t number = 0;
        sim.report_stages([&](const StageState& stage) {
            if (stage.name == name) stage_ = number;
            ++number;
        });
    }
    void before(std::size_t stage) override {
        if (stage == stage_) before_.assign(begin(), end());
    }
    void after(std::size_t stage) override {
        if (stage != stage_) return;
        ++runs, changes += !std::equal(begin(), end(), before_.begin());
    }
    std::int64_t runs = 0, changes = 0;

  private:
    const float* begin() const { return sim_.soft.records().velocity.data() + 4 * first_; }
    const float* end() const { return sim_.soft.records().velocity.data() + 4 * sim_.world.bodies.count; }
    SoftSimulation<float>& sim_;
    std::size_t first_, stage_ = SIZE_MAX;
    std::vector<float> before_;
};

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

    // The first turn of joints and contacts solved all contacts of the world once more:
    // docs/decisions/0104-what-rests-takes-no-time.md.
    TEST_CASE("a car has contacts near it solved in turns, not a heap far away") {
        constexpr std::size_t kFirstOfHeap = 3;
        const auto inside = inside_of<float>(car_and_heap(), Solver::soft);
        auto& sim = static_cast<SoftSimulation<float>&>(*inside);
        ChangesOfStage turns(sim, "solve_joints_and_contacts", kFirstOfHeap),
            all(sim, "solve_paths", kFirstOfHeap);
        for (int i = 0; i < 60; ++i)
            i % 2 == 0 ? sim.step_observed(kStep, turns) : sim.step_observed(kStep, all);
        report("of ", turns.runs, " runs of turns ", turns.changes, " change the heap, of ", all.runs,
               " solves ", all.changes);
        CHECK(turns.runs >= 60);
        CHECK(all.changes > all.runs / 2);
        CHECK(turns.changes < turns.runs / 4);
    }

    // Contacts of a few vehicles are swept behind the sweep of their joints, as those of many are.
    TEST_CASE("contacts of a few vehicles are solved once a substep") {
        Scene scene = car_and_heap();
        const Scene other = car_and_heap();
        for (std::size_t i = 0; i < 3; ++i) {
            Body body = other.bodies[i];
            body.position.x += 20;
            scene.add(body);
        }
        for (Joint joint : other.joints) {
            const auto first = static_cast<std::uint32_t>(other.bodies.size());
            joint.a = BodyId{joint.a->index + first, 0}, joint.b = BodyId{joint.b->index + first, 0};
            auto& hinge = std::get<RevoluteJoint>(joint.kind);
            hinge.anchor = Vec2{hinge.anchor->x + 20, hinge.anchor->y};
            scene.add(joint);
        }
        World world(scene, {.threads = 1});
        REQUIRE(world.plan().joints.find("crowd") != std::string::npos);
        for (int i = 0; i < 30; ++i) world.step(kStep);
        const std::int64_t before = world.profile().path_solves;
        double open = 0;
        constexpr int kSteps = 120;
        for (int i = 0; i < kSteps; ++i) {
            world.step(kStep);
            open = std::max(open, world.joint_errors().max);
        }
        CHECK(world.profile().path_solves - before <= kSteps * (world.plan().substeps + 1));
        report("two cars: hinges open by ", open, " m, overlap ", world.overlaps().max, " inradii");
        CHECK(open < 5e-3);
        CHECK(world.overlaps().max < 0.05);
    }
}

}  // namespace test_mechanisms_on_heaps

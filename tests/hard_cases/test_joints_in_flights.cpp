// Joints in steps that are cut into flights, since a crowd beside them falls far in a step
// (docs/decisions/0105-flights-of-a-step.md): each goes by the step, not by the flight.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "support/effort.hpp"
#include "support/falling_grains.hpp"
#include "support/other_order.hpp"
#include "support/report.hpp"

namespace test_joints_in_flights {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kLongStep = 1.0 / 30, kGravity = 9.8;  // s, m/s²
constexpr int kSteps = 24;

/// Grains in a shaft, and room beside it.
Scene grains_and_room(int count) {
    Scene scene = grains_that_fall(count);
    const double side = scene.walls->max.x;
    scene.walls->max = {20, 20};
    scene.add({.type = BodyType::static_body, .shape = Segment{{side, 0}, {side, 20}}});
    return scene;
}

/// Counts the steps in which pairs are found more than once, as they are in each flight.
template <class Real>
class CutSteps {
  public:
    void step(BasicWorld<Real>& world) {
        const std::int64_t before = world.profile().rebuilds;
        world.step(kLongStep);
        count_ += world.profile().rebuilds > before + 1 ? 1 : 0;
    }
    int count() const { return count_; }

  private:
    int count_ = 0;
};

}  // namespace

TEST_SUITE("hard cases/joints in flights") {
    // One pair of joined grains had kept the steps of all from being cut: 94,000 contacts of 1,000 grains.
    TEST_CASE_TEMPLATE(
        "a crowd of grains beside joints has few contacts a body, and the same bits in any order", Real,
        float, double) {
        const int count = scaled(1000, 400);
        Scene scene = grains_that_fall(count);
        const BodyId last{static_cast<std::uint32_t>(count) - 1, 0}, before{last.index - 1, 0};
        scene.add(Joint{.a = before, .b = last, .kind = RevoluteJoint{}});
        BasicWorld<Real> world(scene, {.threads = 1}), other(scene, in_other_order({}));
        std::int64_t contacts = 0;
        double overlap = 0;
        for (int step = 0; step < kSteps; ++step) {
            world.step(kLongStep), other.step(kLongStep);
            contacts = std::max(contacts, world.profile().contacts);
            overlap = std::fmax(overlap, world.overlaps().mean);
        }
        report(count, " grains, two of them joined: at most ", contacts, " contacts, mean overlap ", overlap);
        CHECK(contacts < 8 * count);
        CHECK(overlap < 0.06);  // without joints .03: what impacts leave closing is swept there
        CHECK(world.quarantined().empty());
        CHECK(world.state_hash() == other.state_hash());
    }

    // What a joint gave in a step is the momentum of its body less what gravity gave.
    TEST_CASE_TEMPLATE("the force of a joint is its mean over the flights of a step", Real, float, double) {
        constexpr double kMass = 2;  // kg
        Scene scene = grains_and_room(400);
        const BodyId bob = scene.add({.shape = Disc{0.2}, .position = {6, 5}, .mass = kMass});
        const JointId rod =
            scene.add(Joint{.b = bob, .kind = DistanceJoint{.anchor_a = {5, 5}, .length = 1}});
        BasicWorld<Real> world(scene, {.threads = 1});
        CutSteps<Real> cut;
        double largest = 0;  // N, of the difference
        for (int step = 0; step < kSteps; ++step) {
            const Vec2 before = world.state(bob).velocity;
            cut.step(world);
            const Vec2 after = world.state(bob).velocity, force = world.joint_force(rod);
            largest = std::fmax(largest, std::fabs(kMass * (after.x - before.x) / kLongStep - force.x));
            largest = std::fmax(largest,
                                std::fabs(kMass * ((after.y - before.y) / kLongStep + kGravity) - force.y));
        }
        report(cut.count(), " steps are cut; forces differ by at most ", largest, " N");
        CHECK(cut.count() > kSteps / 4);
        CHECK(largest < 1e-3 * kMass * kGravity);
    }

    TEST_CASE_TEMPLATE("what a moving limit pushes has its velocity in each flight", Real, float, double) {
        constexpr double kSpeed = 0.6;  // m/s, at first; half of it at the end
        Scene scene = grains_and_room(400);
        const BodyId piston = scene.add({.shape = Box{0.5, 0.2}, .position = {5, 5}});
        PrismaticJoint slider{.axis = {0, 1}};
        slider.lower = 0, slider.upper = 10;
        const JointId lift = scene.add(Joint{.b = piston, .kind = slider});
        BasicWorld<Real> world(scene, {.threads = 1});
        CutSteps<Real> cut;
        double way = 0;  // m
        for (int step = 1; step <= kSteps; ++step) {
            const double speed = kSpeed * (1 - 0.5 * step / kSteps);
            way += speed * kLongStep;
            world.set_limits(lift, way, 10);
            cut.step(world);
            CAPTURE(step);
            CHECK(world.state(piston).position.y == doctest::Approx(5 + way).epsilon(1e-5));
            if (step > 1) CHECK(world.state(piston).velocity.y == doctest::Approx(speed).epsilon(1e-3));
        }
        CHECK(cut.count() > kSteps / 4);
    }

    // A joint that bears 1.5 times the weight of what hangs on it bears it, and breaks where it swings down.
    TEST_CASE_TEMPLATE("a joint breaks by its mean force in a step, and then only", Real, float, double) {
        constexpr double kMass = 1;  // kg
        Scene scene = grains_and_room(400);
        const BodyId still = scene.add({.shape = Disc{0.2}, .position = {5, 4}, .mass = kMass}),
                     swings = scene.add({.shape = Disc{0.2}, .position = {11, 5}, .mass = kMass});
        const auto hang = [&](BodyId bob, Vec2 from) {
            return scene.add(Joint{.b = bob,
                                   .kind = DistanceJoint{.anchor_a = from, .length = 1},
                                   .break_force = 1.5 * kMass * kGravity});
        };
        const JointId holds = hang(still, {5, 5}), breaks = hang(swings, {10, 5});
        BasicWorld<Real> world(scene, {.threads = 1});
        CutSteps<Real> cut;
        Vec2 force{};  // N, in the step before
        for (int step = 0; step < kSteps && world.is_alive(breaks); ++step) {
            force = world.joint_force(breaks);
            cut.step(world);
        }
        CHECK(world.is_alive(holds));
        REQUIRE(!world.is_alive(breaks));
        // At 30 degrees below the level a pendulum let go from it has 3 m g sin 30° in its rod.
        CHECK(std::hypot(force.x, force.y) < 1.5 * kMass * kGravity);
        const Vec2 at = world.state(swings).position;
        CHECK(std::atan2(5 - at.y, at.x - 10) == doctest::Approx(std::numbers::pi / 6).epsilon(0.25));
        CHECK(cut.count() > 0);
    }
}

}  // namespace test_joints_in_flights

// Gears of solver `soft` against exact mechanics.
#include "support/effort.hpp"
#include "support/joints.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

namespace test_gears {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Two wheels on axles, the first one spinning at 3 rad/s before the gears take hold.
/// @param gears  how many, all alike  @param of_joints  whether they couple the hinges, or the bodies
Scene geared_wheels(double ratio, int gears, bool of_joints) {
    Scene scene;
    scene.gravity = {0, -10};
    const BodyId a = scene.add(Body{.shape = Disc{0.5}, .angular_velocity = 3, .mass = 1}),
                 b = scene.add(Body{.shape = Disc{1}, .position = {1.5, 0}, .mass = 3});
    const JointId of_a = scene.add(Joint{.b = a}), of_b = scene.add(Joint{.b = b});
    for (int i = 0; i < gears; ++i) {
        if (of_joints)
            scene.add(Joint{.kind = GearJoint{.first = of_a, .second = of_b, .ratio = ratio}});
        else
            scene.add(Joint{.a = a, .b = b, .kind = GearJoint{.ratio = ratio}});
    }
    return scene;
}

}  // namespace

TEST_SUITE("physics: gears") {
    TEST_CASE_TEMPLATE("geared wheels turn at their ratio for 10,000 steps and share their momentum", Real,
                       float, double) {
        constexpr double kRatio = -0.5, kInertiaA = 0.125, kInertiaB = 1.5;
        for (const int gears : {1, 2})
            for (const bool of_joints : {false, true}) {
                CAPTURE(gears);
                CAPTURE(of_joints);
                BasicWorld<Real> world(geared_wheels(kRatio, gears, of_joints));
                double worst = 0;
                for (int i = 0; i < scaled(10'000, 2'000); ++i) {
                    world.step(kStep);
                    worst = std::max(
                        worst, std::fabs(world.state({1, 0}).angle - kRatio * world.state({0, 0}).angle));
                }
                CHECK(worst < (sizeof(Real) == 4 ? 1e-4 : 1e-10));
                // I_a (w - 3) + ratio L = 0 and I_b ratio w = L: the impulse of the gear at the start.
                const double spin = 3 * kInertiaA / (kInertiaA + kRatio * kRatio * kInertiaB);
                CHECK(world.state({0, 0}).angular_velocity == doctest::Approx(spin).epsilon(1e-5));
                CHECK(world.state({1, 0}).angular_velocity == doctest::Approx(kRatio * spin).epsilon(1e-5));
                CHECK(world.joint_errors().max < 1e-3);
            }
    }

    TEST_CASE("a rack falls against its pinion as one mass with its inertia") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId pinion = scene.add(Body{.shape = Disc{0.5}, .mass = 2}),
                     rack = scene.add(Body{.shape = Disc{0.1}, .position = {0.6, 0}, .mass = 1});
        const JointId hinge = scene.add(Joint{.b = pinion}),
                      slider = scene.add(Joint{.b = rack, .kind = PrismaticJoint{.axis = {0, 1}}}),
                      gear =
                          scene.add(Joint{.kind = GearJoint{.first = hinge, .second = slider, .ratio = 0.5}});
        World64 world(scene);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        // a = -g / (1 + I / (m r²)), I = m_p r² / 2.
        CHECK(world.state(rack).velocity.y == doctest::Approx(-5).epsilon(1e-6));
        CHECK(world.state(rack).position.y == doctest::Approx(-2.5).epsilon(1e-3));
        CHECK(world.state(rack).position.y == doctest::Approx(0.5 * world.state(pinion).angle).epsilon(1e-9));
        CHECK(world.joint_force(gear).y == doctest::Approx(5).epsilon(1e-3));
        CHECK(world.ledger().energy_by_cause.unexplained == doctest::Approx(0).epsilon(1e-6));
        world.remove(hinge);
        CHECK_FALSE(world.is_alive(gear));
        CHECK(world.joint_count() == 1);
        CHECK_THROWS_WITH_AS(world.add(Joint{.kind = GearJoint{.first = hinge, .second = slider}}),
                             doctest::Contains("World::add"), Error);
    }

    TEST_CASE("a gear couples what turns on a body that turns itself") {
        // Two wheels on a free bar: the sum of the three momenta stays, and the wheels turn against the bar.
        Scene scene;
        const BodyId frame = scene.add(bar({0, 0}, 2, 2)),
                     a = scene.add(
                         Body{.shape = Disc{0.3}, .position = {-0.8, 0}, .angular_velocity = 5, .group = -1}),
                     b = scene.add(Body{.shape = Disc{0.4}, .position = {0.8, 0}, .group = -1});
        const JointId of_a = scene.add(Joint{.a = frame, .b = a}),
                      of_b = scene.add(Joint{.a = frame, .b = b});
        scene.add(Joint{.kind = GearJoint{.first = of_a, .second = of_b, .ratio = 2}});
        World64 world(scene);
        const double momentum = world.ledger().angular_momentum;
        for (int i = 0; i < 1000; ++i) world.step(kStep);
        const double turn = world.state(frame).angle;
        CHECK(std::fabs(turn) > 0.3);
        CHECK(world.state(b).angle - turn ==
              doctest::Approx(2 * (world.state(a).angle - turn)).epsilon(1e-9));
        CHECK(world.ledger().angular_momentum == doctest::Approx(momentum).epsilon(1e-6));
    }

    TEST_CASE("gears that cannot be are refused with what they lack") {
        const auto message_of = [](auto change) {
            Scene scene = geared_wheels(1, 1, true);
            change(scene.joints);
            const auto found = scene.find_problem();
            return found ? found->pointer + ": " + found->statement : std::string();
        };
        using Joints = std::vector<Joint>&;
        const auto gear_of = [](Joints joints) -> GearJoint& { return std::get<GearJoint>(joints[2].kind); };
        CHECK(message_of([](Joints) {}).empty());
        CHECK(message_of([&](Joints j) { gear_of(j).ratio = 0; }).find("/joints/2/gear/ratio") == 0);
        CHECK(message_of([&](Joints j) { gear_of(j).second.reset(); }).find("/joints/2/gear/second") == 0);
        CHECK(message_of([&](Joints j) { gear_of(j).second = gear_of(j).first; }).find("two joints") !=
              std::string::npos);
        CHECK(message_of([&](Joints j) {
                  gear_of(j).second = JointId::of(2);
              }).find("does not come before it") != std::string::npos);
        CHECK(message_of([&](Joints j) { j[0].kind = WeldJoint{}; }).find("cannot couple") !=
              std::string::npos);
        CHECK(message_of([&](Joints j) { j[2].b = BodyId{1, 0}; }).find("one of both") != std::string::npos);
        CHECK(message_of([&](Joints j) { gear_of(j) = {}; }).find("no two bodies") != std::string::npos);
    }
}

}  // namespace test_gears

// Nets of springs, ropes, limits and motors, and crowds of small mechanisms, which are swept by lanes.
#include "support/joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "support/report.hpp"

namespace test_joint_nets {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// A net whose whole upper row hangs.
Scene curtain(int count, const JointKind& link) {
    Scene scene = hanging_net(count);
    for (int x = 0; x < count; ++x)
        scene.bodies[static_cast<std::size_t>((count - 1) * count + x)].type = BodyType::static_body;
    std::erase_if(scene.joints, [&](const Joint& joint) {
        return scene.bodies[joint.a->index].type == BodyType::static_body;
    });
    for (Joint& joint : scene.joints) joint.kind = link;
    return scene;
}

void check_swept(const Scene& scene) {
    CHECK(World(scene).plan().joints.find("one by one") == std::string::npos);
    CHECK(World(scene).plan().joints.find("swept") != std::string::npos);
}

/// A heap of `count` figures of a trunk and four limbs on hinges with limits, over a floor.
Scene figures(int count) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls.emplace();
    scene.walls->max = {8, 1000};
    scene.walls->top = false;
    scene.walls->material.friction = 0.5;
    for (int i = 0; i < count; ++i) {
        const double x = 1 + 1.5 * (i % 5) + 0.1 * (i / 5 % 2), y = 1 + 1.5 * (i / 5);
        const auto limb = [&](Vec2 at) {
            return scene.add({.shape = Disc{0.2},
                              .position = at,
                              .mass = 1,
                              .material = {.friction = 0.5},
                              .group = -1 - i});
        };
        const BodyId trunk = limb({x, y});
        for (const Vec2 way : {Vec2{1, 1}, Vec2{-1, 1}, Vec2{1, -1}, Vec2{-1, -1}}) {
            const BodyId b = limb({x + 0.3 * way.x, y + 0.3 * way.y});
            scene.add(
                Joint{.a = trunk,
                      .b = b,
                      .kind = RevoluteJoint{
                          .anchor = Vec2{x + 0.15 * way.x, y + 0.15 * way.y}, .lower = -0.5, .upper = 0.5}});
        }
    }
    return scene;
}

/// Four by four discs on rods, hinges and welds as they are drawn, in a hexagon that turns. With this draw
/// loops of the net are drawn taut against each other.
Scene net_in_a_drum(double radius, double speed, bool turns) {
    constexpr int kSide = 4;
    std::mt19937 draws(15);
    const auto draw = [&] { return static_cast<double>(draws()) / 0x1p32; };
    Scene scene;
    scene.gravity = {0, -10};
    scene.effects.ledger = true;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            scene.add({.shape = Disc{0.4},
                       .position = {x - 1.5, y - 1.5},
                       .mass = 1,
                       .material = {.friction = 0.5},
                       .fixed_rotation = !turns});
    Chain hexagon{.loop = true};
    for (int k = 0; k < 6; ++k) {
        const double angle = k * std::numbers::pi / 3;
        hexagon.points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    Body drum{.shape = hexagon, .material = {.friction = 0.5}};
    drum.type = BodyType::kinematic_body, drum.angular_velocity = speed;
    scene.add(drum);
    const auto link = [&](std::uint32_t a, std::uint32_t b) {
        const Vec2 from = scene.bodies[a].position, to = scene.bodies[b].position,
                   middle{0.5 * (from.x + to.x), 0.5 * (from.y + to.y)};
        const double kind = draw();
        Joint joint{.a = BodyId{a, 0}, .b = BodyId{b, 0}, .kind = WeldJoint{}};
        if (kind < 0.8) joint.kind = RevoluteJoint{.anchor = middle};
        if (kind < 0.35) joint.kind = DistanceJoint{};
        scene.add(joint);
    };
    for (std::uint32_t i = 0; i < kSide * kSide; ++i) {
        if (i % kSide + 1 < kSide && draw() < 0.75) link(i, i + 1);
        if (i / kSide + 1 < kSide && draw() < 0.9) link(i, i + kSide);
    }
    return scene;
}

}  // namespace

TEST_SUITE("hard cases: nets of joints") {
    TEST_CASE_TEMPLATE("a net whose loops pull against each other gains no energy by it", Real, float,
                       double) {
        constexpr double kLifted = 16 * 10 * 4;  // J, of all discs by 4 m
        for (const double radius : {4.0, 5.0})
            for (const double speed : {2.0, 4.0}) {
                CAPTURE(radius);
                CAPTURE(speed);
                const Scene scene = net_in_a_drum(radius, speed, true);
                CHECK(World(scene).plan().joints.find("close loops") != std::string::npos);
                BasicWorld<Real> world(scene);
                double least = 0, rise = 0;
                for (int i = 0; i < 600; ++i) {
                    world.step(kStep);
                    const double given = world.ledger().energy_by_cause.joints;
                    least = std::min(least, given), rise = std::max(rise, given - least);
                }
                report("a net in a drum of ", radius, " m, ", speed, " rad/s: joints gave at most ",
                       rise / kLifted, " of what lifts the net by 4 m");
                CHECK(rise < 0.1 * kLifted);
                CHECK(world.joint_errors().max < 0.1);
                CHECK(world.profile().quarantined == 0);
            }
    }

    TEST_CASE_TEMPLATE("a curtain of springs hangs as far as its weight draws it", Real, float, double) {
        constexpr int kCount = 12;
        constexpr double kFrequency = 5;
        const Scene scene = curtain(kCount, DistanceJoint{.frequency = kFrequency, .damping_ratio = 0.5});
        check_swept(scene);
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 1200; ++i) world.step(kStep);
        // k of a spring = reduced mass · w²: 1/2 between bobs of 1 kg, 1 at the top.
        const double w = 2 * std::numbers::pi * kFrequency;
        const auto y_of = [&](int row) {
            return world.state({static_cast<std::uint32_t>(row * kCount + kCount / 2), 0}).position.y;
        };
        for (int row = 0; row + 1 < kCount; ++row) {
            CAPTURE(row);
            const double below = row + 1, k = (row + 2 == kCount ? 1.0 : 0.5) * w * w;
            // A damped spring gives way by 2 pi f h times its damping ratio less, 4.4 %.
            CHECK(std::fabs((y_of(row + 1) - y_of(row) - 1) / (10 * below / k) - 1) < 0.07);
        }
    }

    TEST_CASE_TEMPLATE("no stiffness and no damping makes a curtain explode", Real, float, double) {
        for (const double frequency : {1.0, 30.0, 1e3, 1e6})
            for (const double ratio : {0.0, 1.0, 100.0}) {
                CAPTURE(frequency);
                CAPTURE(ratio);
                BasicWorld<Real> world(
                    curtain(10, DistanceJoint{.frequency = frequency, .damping_ratio = ratio}));
                const double start = world.ledger().energy.total();
                for (int i = 0; i < 200; ++i) world.step(kStep);
                const Energy energy = world.ledger().energy;
                CHECK(energy.kinetic + energy.rotational < 200 * 10);
                CHECK(energy.potential <= start + 1);
            }
    }

    // A rod whose ends pass each other grows with the square of their speed in a substep: a fast spin made of
    // that a faster one, until no velocity was a number.
    TEST_CASE_TEMPLATE("a disc that spins fast in a net of rods at its rim gives the net no energy", Real,
                       float, double) {
        constexpr int kCount = 8;
        constexpr double kRadius = 0.1;  // m
        for (const double spin : {1e2, 1e3, 1e4, 1e5, 1e6}) {
            CAPTURE(spin);
            Scene scene;
            for (int y = 0; y < kCount; ++y)
                for (int x = 0; x < kCount; ++x)
                    scene.add({.shape = Disc{kRadius},
                               .position = {1.0 * x, 1.0 * y},
                               .angular_velocity = x == 4 && y == 4 ? spin : 0});
            const auto join = [&](int from, int to, Vec2 way) {
                scene.add(Joint{.a = BodyId{static_cast<std::uint32_t>(from), 0},
                                .b = BodyId{static_cast<std::uint32_t>(to), 0},
                                .kind = DistanceJoint{.anchor_a = {kRadius * way.x, kRadius * way.y},
                                                      .anchor_b = {-kRadius * way.x, -kRadius * way.y}}});
            };
            for (int y = 0; y < kCount; ++y)
                for (int x = 0; x < kCount; ++x) {
                    if (x + 1 < kCount) join(y * kCount + x, y * kCount + x + 1, {1, 0});
                    if (y + 1 < kCount) join(y * kCount + x, (y + 1) * kCount + x, {0, 1});
                }
            check_swept(scene);
            BasicWorld<Real> world(scene);
            const auto energy = [&] {
                const Energy now = world.ledger().energy;
                return now.kinetic + now.rotational;
            };
            const double start = energy();
            for (int i = 0; i < 300; ++i) {
                world.step(kStep);
                REQUIRE(world.quarantined().empty());
                CHECK(energy() < start);
            }
            CHECK(world.joint_errors().max < 0.02);
        }
    }

    TEST_CASE("a net of ropes falls until they are taut and no farther") {
        const Scene scene = curtain(10, DistanceJoint{.max = 1.2});
        check_swept(scene);
        World world(scene);
        for (int i = 0; i < 600; ++i) world.step(kStep);
        // The lowest bob of the middle column hangs on nine ropes.
        CHECK(world.state({5, 0}).position.y == doctest::Approx(9 - 9 * 1.2).epsilon(0.01));
        CHECK(world.joint_errors().max < 0.02);
    }

    TEST_CASE_TEMPLATE("a plate of welds bends as little as its weight makes it", Real, float, double) {
        Scene scene = hanging_net(8);
        for (Body& body : scene.bodies) body.shape = Disc{0.4};
        for (Joint& joint : scene.joints) joint.kind = WeldJoint{};
        check_swept(scene);
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 300; ++i) world.step(kStep);
        for (std::uint32_t i = 0; i < 64; ++i) CHECK(std::fabs(world.state({i, 0}).angle) < 0.03);
        CHECK(world.joint_errors().max < 0.03);
    }

    TEST_CASE_TEMPLATE("hinges in a net stop at their limits, and motors turn at their speed", Real, float,
                       double) {
        Scene scene = hanging_net(8);
        for (Body& body : scene.bodies) body.shape = Disc{0.4};
        for (Joint& joint : scene.joints) joint.kind = RevoluteJoint{.lower = -0.2, .upper = 0.1};
        const BodyId wheel = scene.add(bob({3.5, -1}, 0.2, 0.2));
        scene.add(Joint{
            .a = BodyId{3, 0}, .b = wheel, .kind = RevoluteJoint{.motor_speed = 6, .max_motor_torque = 5}});
        check_swept(scene);
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 300; ++i) world.step(kStep);
        for (std::size_t j = 0; j + 1 < scene.joints.size(); ++j) {
            const double turn = world.state(*scene.joints[j].b).angle - world.state(*scene.joints[j].a).angle;
            CHECK(turn > -0.25);
            CHECK(turn < 0.15);
        }
        CHECK(world.state(wheel).angular_velocity - world.state({3, 0}).angular_velocity ==
              doctest::Approx(6).epsilon(0.01));
    }

    TEST_CASE("a crowd of figures is swept, comes to rest and holds together") {
        World many(figures(80));
        CHECK(World(figures(2)).plan().joints.find("2 of a crowd") != std::string::npos);
        CHECK(World(figures(1)).plan().joints.find("swept") == std::string::npos);
        CHECK(many.plan().joints.find("80 of a crowd") != std::string::npos);
        CHECK(many.plan().substeps == 4);
        const auto largest_gap = [&] {
            double largest = 0;
            for (std::uint32_t j = 0; j < 320; ++j) {
                const auto [from, to] = many.joint_anchors(JointId::of(j));
                largest = std::max(largest, std::hypot(to.x - from.x, to.y - from.y));
            }
            return largest;
        };
        double worst = 0;
        for (int i = 0; i < 600; ++i) {
            many.step(kStep);
            worst = std::max(worst, largest_gap());
        }
        CHECK(worst < 0.08);                    // in the fall
        CHECK(largest_gap() < 0.016);           // 4 % of a limb of 0.4 m, in a stack of 16 figures
        CHECK(many.joint_errors().max < 0.02);  // limits
        CHECK(many.ledger().energy.kinetic < 1);
        CHECK(many.overlaps().mean < 0.02);
    }

    TEST_CASE_TEMPLATE("motors and limits that are set drive a crowd from the next step on", Real, float,
                       double) {
        constexpr double kTorque = 100;  // N m, more than any limb needs
        Scene scene = figures(20);
        scene.gravity = {}, scene.walls.reset();
        for (Joint& joint : scene.joints) {
            auto& hinge = std::get<RevoluteJoint>(joint.kind);
            hinge.lower = -20, hinge.upper = 20;
            hinge.motor_speed = 2, hinge.max_motor_torque = kTorque;
        }
        BasicWorld<Real> world(scene);
        REQUIRE(world.plan().joints.find("20 of a crowd") != std::string::npos);
        const auto joints = static_cast<std::uint32_t>(scene.joints.size());
        const auto step = [&](int steps) {
            for (int i = 0; i < steps; ++i) world.step(kStep);
        };
        const auto check_speeds = [&](double speed) {
            CAPTURE(speed);
            for (const Joint& joint : scene.joints)
                CHECK(world.state(*joint.b).angular_velocity - world.state(*joint.a).angular_velocity ==
                      doctest::Approx(speed).epsilon(0.01));
        };
        step(30);
        check_speeds(2);
        for (std::uint32_t j = 0; j < joints; ++j) world.set_motor(JointId::of(j), -3, kTorque);
        step(30);
        check_speeds(-3);
        for (std::uint32_t j = 0; j < joints; ++j) world.set_limits(JointId::of(j), -1.25, 1.25);
        step(60);
        for (const Joint& joint : scene.joints)
            CHECK(world.state(*joint.b).angle - world.state(*joint.a).angle ==
                  doctest::Approx(-1.25).epsilon(0.01));
        check_speeds(0);
    }

    TEST_CASE_TEMPLATE(
        "a net with a disc that turns faster than a substep can follow loses none of its bodies", Real, float,
        double) {
        constexpr int kSide = 14;
        for (const double spin : {100.0, 800.0, 1600.0, 5000.0, 50000.0}) {
            CAPTURE(spin);
            Scene scene;
            std::vector<BodyId> ids;
            for (int i = 0; i < kSide * kSide; ++i) {
                Body disc{.shape = Disc{0.2}, .position = {1.0 * (i % kSide), 1.0 * (i / kSide)}};
                if (i == kSide * (kSide / 2) + kSide / 2) disc.angular_velocity = spin;
                ids.push_back(scene.add(disc));
            }
            const auto hinge = [&](int i, int other) {
                const Vec2 p = scene.bodies[static_cast<std::size_t>(i)].position,
                           q = scene.bodies[static_cast<std::size_t>(other)].position;
                scene.add(Joint{.a = ids[static_cast<std::size_t>(i)],
                                .b = ids[static_cast<std::size_t>(other)],
                                .kind = RevoluteJoint{.anchor = Vec2{0.5 * (p.x + q.x), 0.5 * (p.y + q.y)}}});
            };
            for (int i = 0; i < kSide * kSide; ++i) {
                if (i % kSide + 1 < kSide) hinge(i, i + 1);
                if (i / kSide + 1 < kSide) hinge(i, i + kSide);
            }
            check_swept(scene);
            BasicWorld<Real> world(scene);
            const double start = world.ledger().energy.total();
            for (int i = 0; i < 120; ++i) {
                world.step(kStep);
                CHECK(world.ledger().energy.total() < 0.1 * start);  // a hard stop takes the most of it
            }
            CHECK(world.profile().quarantined == 0);
        }
    }

    TEST_CASE_TEMPLATE("a disc that turns about a hinge of a net by many turns in a step stays on it", Real,
                       float, double) {
        constexpr int kSide = 14;
        constexpr double kArm = 0.15;  // m
        for (const double spin : {300.0, 2e3, 2e4}) {
            CAPTURE(spin);
            Scene scene = hanging_net(kSide);
            scene.gravity = {};
            const BodyId disc = scene.add({.shape = Disc{0.2},
                                           .position = {kSide / 2 + kArm, kSide / 2},
                                           .velocity = {0, spin * kArm},
                                           .angular_velocity = spin,
                                           .mass = 0.1});
            scene.add(Joint{.a = BodyId{kSide * (kSide / 2) + kSide / 2, 0},
                            .b = disc,
                            .kind = RevoluteJoint{.anchor = Vec2{kSide / 2, kSide / 2}}});
            check_swept(scene);
            BasicWorld<Real> world(scene);
            const double start = world.ledger().energy.total();
            double most = 0;
            for (int i = 0; i < 120; ++i) {
                world.step(kStep);
                most = std::max(most, world.ledger().energy.total() / start);
            }
            CAPTURE(most);
            CHECK(most < 1.001);
            CHECK(world.profile().quarantined == 0);
        }
    }

    TEST_CASE_TEMPLATE("nets of all that lanes know give the same bits for every instruction set and thread",
                       Real, float, double) {
        Scene mixed = hanging_net(10);
        const JointKind kinds[] = {DistanceJoint{.frequency = 4, .damping_ratio = 0.3},
                                   DistanceJoint{.max = 1.1},
                                   RevoluteJoint{.lower = -0.1, .upper = 0.1},
                                   RevoluteJoint{.motor_speed = 1, .max_motor_torque = 2},
                                   WeldJoint{},
                                   WeldJoint{.frequency = 3},
                                   DistanceJoint{.anchor_a = {0.1, 0}, .min = 0.9}};
        for (std::size_t j = 0; j < mixed.joints.size(); ++j) mixed.joints[j].kind = kinds[j % 7];
        for (const Scene& scene : {mixed, figures(70)}) {
            const auto hash = [&](const std::string& isa, int threads) {
                BasicWorld<Real> world(scene, {.isa = isa, .threads = threads});
                for (int i = 0; i < 40; ++i) world.step(kStep);
                return world.state_hash();
            };
            const std::uint64_t expected = hash("scalar", 1);
            for (const std::string& isa : runnable_instruction_sets()) CHECK(hash(isa, 2) == expected);
        }
    }

    // Forces of swept joints were those of the last substep: they told of 7 N or of 7,800 N of a blow of
    // 3,600 N.
    TEST_CASE_TEMPLATE("joints of a net that may break tell of a blow whenever in a step it comes", W, World,
                       World64) {
        constexpr int kSide = 6;
        constexpr double kSize = 0.5, kSpeed = 15, kMass = 0.25;  // m, m/s, kg
        for (const double part : {0.0, 0.25, 0.5, 0.75}) {
            Scene scene;
            scene.gravity = {};
            std::vector<BodyId> boxes;
            for (int i = 0; i < kSide * kSide; ++i)
                boxes.push_back(scene.add({.shape = Box{kSize, kSize},
                                           .position = {kSize * (i % kSide), kSize * (i / kSide)},
                                           .mass = kMass}));
            std::vector<JointId> cut;  // between the first column and the second
            const auto weld = [&](int a, int b) {
                const Vec2 from = scene.bodies[static_cast<std::size_t>(a)].position,
                           to = scene.bodies[static_cast<std::size_t>(b)].position;
                return scene.add(
                    Joint{.a = boxes[static_cast<std::size_t>(a)],
                          .b = boxes[static_cast<std::size_t>(b)],
                          .kind = WeldJoint{.anchor = Vec2{0.5 * (from.x + to.x), 0.5 * (from.y + to.y)}},
                          .break_force = 1e9});
            };
            for (int i = 0; i < kSide * kSide; ++i) {
                if (i % kSide + 1 < kSide) {
                    const JointId joint = weld(i, i + 1);
                    if (i % kSide == 0) cut.push_back(joint);
                }
                if (i / kSide + 1 < kSide) weld(i, i + kSide);
            }
            scene.add({.shape = Box{kSize, kSide * kSize},
                       .position = {-kSize - kSpeed * kStep * (2 + part), 0.5 * kSize * (kSide - 1)},
                       .velocity = {kSpeed, 0},
                       .mass = kMass * kSide * kSide});
            W world(scene, {.threads = 1});
            REQUIRE(world.plan().joints.find("swept by lanes") != std::string::npos);
            double told = 0;  // N s
            for (int i = 0; i < 8; ++i) {
                world.step(kStep);
                for (const JointId joint : cut) told += kStep * world.joint_force(joint).x;
            }
            double momentum = 0;  // kg m/s, of what is behind the cut
            for (int i = 0; i < kSide * kSide; ++i)
                if (i % kSide > 0)
                    momentum += kMass * world.state(boxes[static_cast<std::size_t>(i)]).velocity.x;
            INFO("hit at ", part, " of a step");
            CHECK(told == doctest::Approx(momentum).epsilon(0.02));
        }
    }
}

}  // namespace test_joint_nets

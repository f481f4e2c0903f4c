// Joints of solver `soft` against exact mechanics: A3, A23, A24, A35 of docs/exact-cases.md, B5 of
// docs/hard-cases.md.
#include "support/joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <doctest/doctest.h>

namespace test_joints {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kPi = std::numbers::pi;

template <class Real>
double energy_of(const BasicWorld<Real>& world) {
    return world.ledger().energy.total();
}

/// Mean period of the zero crossings of x, by straight lines between steps [s].
template <class Real>
double period_of(const Scene& scene, double seconds, double dt, const WorldOptions& options = {}) {
    BasicWorld<Real> world(scene, options);
    double before = world.bodies().position_x[0], first = -1, last = -1;
    int crossings = 0;
    for (int i = 1; i * dt <= seconds; ++i) {
        world.step(dt);
        const double now = world.bodies().position_x[0];
        if (before > 0 && now <= 0) {
            last = (i - now / (now - before)) * dt;
            if (first < 0) first = last;
            ++crossings;
        }
        before = now;
    }
    REQUIRE(crossings > 1);
    return (last - first) / (crossings - 1);
}

template <class Real>
double worst_energy(const Scene& scene, int steps, double unit, const WorldOptions& options = {}) {
    BasicWorld<Real> world(scene, options);
    const double start = energy_of(world);
    double worst = 0;
    for (int i = 0; i < steps; ++i) {
        world.step(kStep);
        worst = std::max(worst, std::fabs(energy_of(world) - start) / unit);
    }
    return worst;
}

/// The displacement of a damped oscillator that starts at 1 at rest.
double oscillation(double frequency, double ratio, double t) {
    const double w = 2 * kPi * frequency;
    if (ratio < 1) {
        const double d = w * std::sqrt(1 - ratio * ratio);
        return std::exp(-ratio * w * t) * (std::cos(d * t) + ratio * w / d * std::sin(d * t));
    }
    const double d = w * std::sqrt(ratio * ratio - 1);
    return 0.5 * (std::exp((d - ratio * w) * t) * (1 + ratio * w / d) +
                  std::exp((-d - ratio * w) * t) * (1 - ratio * w / d));
}

}  // namespace

TEST_SUITE("physics: joints") {
    TEST_CASE_TEMPLATE(
        "a free dumbbell keeps its energy within 1e-4 in 10,000 steps, its spin and its tension", Real, float,
        double) {
        Scene scene;
        const BodyId a = scene.add(bob({-0.5, 0})), b = scene.add(bob({0.5, 0}));
        scene.bodies[0].velocity = {0, -2.5}, scene.bodies[1].velocity = {0, 2.5};
        const JointId rod = scene.add(Joint{.a = a, .b = b, .kind = DistanceJoint{}});
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 10'000; ++i) world.step(kStep);
        CHECK(world.ledger().energy.total() == doctest::Approx(6.25).epsilon(1e-4));
        const BodyState end = world.state(b);
        CHECK(std::hypot(end.velocity.x, end.velocity.y) == doctest::Approx(2.5).epsilon(1e-4));
        // m w² r: the mean over a step of a force that turns by 5 / 60 rad in it.
        const Vec2 force = world.joint_force(rod);
        CHECK(std::hypot(force.x, force.y) == doctest::Approx(12.5).epsilon(2e-3));
        CHECK(world.joint_errors().max < 1e-5);
    }

    TEST_CASE_TEMPLATE("a rod pendulum has the period of the elliptic integral and its energy", Real, float,
                       double) {
        const double small = 2 * kPi * std::sqrt(1 / 10.0);
        // T / T0 = (2 / pi) K(sin(angle / 2)), physics.md A23.
        CHECK(period_of<Real>(rod_pendulum(kPi / 2), 20, kStep) ==
              doctest::Approx(1.180341 * small).epsilon(5e-4));
        CHECK(period_of<Real>(rod_pendulum(kPi * 120 / 180), 20, kStep) ==
              doctest::Approx(1.372881 * small).epsilon(5e-4));
        CHECK(period_of<Real>(rod_pendulum(kPi * 170 / 180), 30, kStep) ==
              doctest::Approx(2.439363 * small).epsilon(2e-3));
        CHECK(worst_energy<Real>(rod_pendulum(kPi / 2), 1200, 10) < 2e-4);
    }

    TEST_CASE("a pendulum's energy error falls with the square of the substep") {
        // Small discs ask for more substeps; these are large enough for one.
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId b = scene.add(bob({1, 0}, 1, 3));
        scene.add(Joint{.b = b, .kind = DistanceJoint{}});
        const double one = worst_energy<double>(scene, 600, 10, {.substeps = 1}),
                     two = worst_energy<double>(scene, 600, 10, {.substeps = 2}),
                     four = worst_energy<double>(scene, 600, 10, {.substeps = 4});
        CHECK(one < 1.5e-3);
        CHECK(one / two == doctest::Approx(4).epsilon(0.1));
        CHECK(two / four == doctest::Approx(4).epsilon(0.1));
    }

    TEST_CASE_TEMPLATE("a bar on a hinge swings as a physical pendulum", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId b = scene.add(bar({0, -0.5}, 1));
        scene.bodies[0].position = {0.5 * std::sin(0.2), -0.5 * std::cos(0.2)};
        scene.bodies[0].angle = 0.2;
        scene.add(Joint{.b = b, .kind = RevoluteJoint{.anchor = Vec2{0, 0}}});
        // 2 pi sqrt(I / (m g l)) with I = 1/12 + 1/4, and 1 + angle² / 16.
        const double exact = 2 * kPi * std::sqrt((1.0 / 3) / (10 * 0.5)) * (1 + 0.2 * 0.2 / 16);
        CHECK(period_of<Real>(scene, 20, kStep) == doctest::Approx(exact).epsilon(2e-4));
    }

    TEST_CASE_TEMPLATE("a double pendulum keeps its energy", Real, float, double) {
        for (const bool of_rods : {true, false}) {
            CAPTURE(of_rods);
            Scene scene;
            scene.gravity = {0, -10};
            const BodyId a = scene.add(of_rods ? bob({1, 0}) : bar({0.5, 0}, 1)),
                         b = scene.add(of_rods ? bob({2, 0}) : bar({1.5, 0}, 1));
            if (of_rods) {
                scene.add(Joint{.b = a, .kind = DistanceJoint{}});
                scene.add(Joint{.a = a, .b = b, .kind = DistanceJoint{}});
            } else {
                scene.add(Joint{.b = a, .kind = RevoluteJoint{.anchor = Vec2{0, 0}}});
                scene.add(Joint{.a = a, .b = b, .kind = RevoluteJoint{.anchor = Vec2{1, 0}}});
            }
            CHECK(worst_energy<Real>(scene, 600, 20) < 2e-3);
        }
    }

    TEST_CASE("a spring alone is exact, whatever the step") {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 240})
            for (const double frequency : {1.0, 3.0, 10.0}) {
                CAPTURE(dt);
                CAPTURE(frequency);
                Scene scene;
                const BodyId b = scene.add(bob({1.1, 0}));
                scene.add(Joint{.b = b, .kind = DistanceJoint{.length = 1, .frequency = frequency}});
                World64 world(scene);
                double worst = 0;
                for (int i = 1; i <= 300; ++i) {
                    world.step(dt);
                    const double off = 10 * (world.state(b).position.x - 1);
                    worst = std::max(worst, std::fabs(off - oscillation(frequency, 0, i * dt)));
                }
                CHECK(worst < 1e-6);
            }
    }

    TEST_CASE("the decay and the frequency of a damped spring do not depend on the step") {
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120, 1.0 / 240})
            for (const double ratio : {0.05, 0.2, 0.5}) {
                CAPTURE(dt);
                CAPTURE(ratio);
                const double frequency = 2;
                Scene scene;
                const BodyId b = scene.add(bob({1.1, 0}));
                scene.add(Joint{
                    .b = b,
                    .kind = DistanceJoint{.length = 1, .frequency = frequency, .damping_ratio = ratio}});
                World64 world(scene);
                // After whole steps a linear map has the decay of the flow if x(2T) x(0) = ... of three
                // samples: x0 x2 - x1² of equidistant samples falls by e^(-2 z w T) a sample.
                std::vector<double> x;
                const int stride = static_cast<int>(std::lround(0.1 / dt));
                for (int i = 0; i <= 5 * stride; ++i) {
                    if (i % stride == 0) x.push_back(world.state(b).position.x - 1);
                    world.step(dt);
                }
                const double span = stride * dt, w = 2 * kPi * frequency;
                const double fall = (x[2] * x[4] - x[3] * x[3]) / (x[1] * x[3] - x[2] * x[2]);
                CHECK(fall == doctest::Approx(std::exp(-2 * ratio * w * span)).epsilon(1e-6));
                const double trace = (x[4] * x[1] - x[3] * x[2]) / (x[3] * x[1] - x[2] * x[2]);
                const double exact =
                    2 * std::exp(-ratio * w * span) * std::cos(w * std::sqrt(1 - ratio * ratio) * span);
                CHECK(trace == doctest::Approx(exact).epsilon(1e-6));
            }
    }

    TEST_CASE("ten springs in line have the lowest frequency of a chain") {
        Scene scene;
        std::optional<BodyId> last;
        const int count = 10;
        for (int i = 0; i < count; ++i) {
            // The lowest mode of a chain that is fixed at one end.
            const double mode = std::sin((i + 1) * kPi / (2 * count + 1));
            const BodyId b = scene.add(bob({i + 1 + 0.01 * mode, 0}));
            // The mass on a spring between two masses of 1 kg is 1/2 kg; the first hangs on the world.
            const double frequency = 3 * (last ? std::sqrt(2.0) : 1);
            scene.add(Joint{.a = last, .b = b, .kind = DistanceJoint{.length = 1, .frequency = frequency}});
            last = b;
        }
        World64 world(scene);
        const double exact = 2 * 3 * std::sin(kPi / (2 * (2 * count + 1)));  // Hz
        double before = 1, first = -1, now = 0;
        int crossings = 0;
        double end = 0;
        for (int i = 1; i <= 1200; ++i) {
            world.step(kStep);
            now = world.state(*last).position.x - count;
            if (before > 0 && now <= 0) {
                end = (i - now / (now - before)) * kStep;
                if (first < 0) first = end;
                ++crossings;
            }
            before = now;
        }
        REQUIRE(crossings > 5);
        CHECK((crossings - 1) / (end - first) == doctest::Approx(exact).epsilon(5e-3));
    }

    TEST_CASE_TEMPLATE("no stiffness makes springs explode", Real, float, double) {
        for (const double frequency : {30.0, 300.0, 1e5})
            for (const double ratio : {0.0, 1.0, 100.0}) {
                CAPTURE(frequency);
                CAPTURE(ratio);
                Scene scene;
                scene.gravity = {0, -10};
                std::optional<BodyId> last;
                for (int i = 0; i < 10; ++i) {
                    const BodyId b = scene.add(bob({i + 1.0, 0}));
                    scene.add(Joint{.a = last,
                                    .b = b,
                                    .kind = DistanceJoint{.frequency = frequency, .damping_ratio = ratio}});
                    last = b;
                }
                BasicWorld<Real> world(scene);
                const double start = energy_of(world);
                for (int i = 0; i < 600; ++i) world.step(kStep);
                CHECK(energy_of(world) < start + 1);
                CHECK(world.quarantined().empty());
            }
    }

    TEST_CASE_TEMPLATE("each link of a hanging chain carries what is below it", Real, float, double) {
        for (const auto& [links, weight] : {std::pair{8, 5.0}, std::pair{40, 1000.0}})
            for (const Solver solver : {Solver::soft, Solver::rattle}) {
                BasicWorld<Real> world(weighted_chain(links, weight, {0, -1}), {.solver = solver});
                for (int i = 0; i < 60; ++i) world.step(kStep);
                for (int i = 0; i <= links; ++i) {
                    CAPTURE(i);
                    const double below = 10 * (links - i + weight);
                    const Vec2 force = world.joint_force(JointId::of(static_cast<std::uint32_t>(i)));
                    CHECK(force.y == doctest::Approx(below).epsilon(sizeof(Real) == 4 ? 1e-6 : 1e-12));
                    CHECK(std::fabs(force.x) < 1e-6 * below);
                }
            }
    }

    TEST_CASE_TEMPLATE("a chain of 40 links holds 50,000 times the weight of a link", Real, float, double) {
        for (const bool swings : {false, true}) {
            CAPTURE(swings);
            BasicWorld<Real> world(weighted_chain(40, 5e4, swings ? Vec2{1, 0} : Vec2{0, -1}));
            double worst = 0;
            for (int i = 0; i < 300; ++i) {
                world.step(kStep);
                worst = std::max(worst, world.joint_errors().max);
            }
            CHECK(worst < (swings ? 0.01 : 0.001));
        }
    }

    TEST_CASE("a motor turns a wheel at its speed, or with its torque") {
        Scene scene;
        const BodyId b = scene.add(bob({0, 0}, 2, 0.5));
        const JointId hinge =
            scene.add(Joint{.b = b, .kind = RevoluteJoint{.motor_speed = 6, .max_motor_torque = 0.5}});
        World world(scene);
        const double inertia = 0.5 * 2 * 0.5 * 0.5;
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state(b).angular_velocity == doctest::Approx(0.5 / inertia).epsilon(1e-4));
        CHECK(world.joint_torque(hinge) == doctest::Approx(0.5).epsilon(1e-4));
        for (int i = 0; i < 240; ++i) world.step(kStep);
        CHECK(world.state(b).angular_velocity == doctest::Approx(6).epsilon(1e-5));
        CHECK(std::fabs(world.joint_torque(hinge)) < 1e-4);
        world.set_motor(hinge, -6, 1000);
        world.step(kStep);
        CHECK(world.state(b).angular_velocity == doctest::Approx(-6).epsilon(1e-5));
    }

    TEST_CASE("an arm that falls stops at its limit and hangs there with its weight") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId b = scene.add(bar({0.5, 0}, 1));
        const JointId hinge =
            scene.add(Joint{.b = b, .kind = RevoluteJoint{.anchor = Vec2{0, 0}, .lower = -0.5, .upper = 1}});
        World world(scene);
        double lowest = 0;
        for (int i = 0; i < 240; ++i) {
            world.step(kStep);
            lowest = std::min(lowest, world.state(b).angle);
        }
        CHECK(lowest > -0.5 - 1e-3);
        CHECK(world.state(b).angle == doctest::Approx(-0.5).epsilon(1e-4));
        CHECK(world.joint_torque(hinge) == doctest::Approx(0.5 * 10 * std::cos(0.5)).epsilon(1e-3));
        world.set_limits(hinge, -1.2, 1);
        for (int i = 0; i < 240; ++i) world.step(kStep);
        CHECK(world.state(b).angle == doctest::Approx(-1.2).epsilon(1e-4));
    }

    TEST_CASE_TEMPLATE("what a motor drives against its limit stands there", Real, float, double) {
        for (const double gravity : {0.0, -10.0})
            for (const double force : {5.0, 50.0, 500.0})  // N, and N m
                for (const double speed : {0.25, -2.0}) {
                    CAPTURE(gravity);
                    CAPTURE(force);
                    CAPTURE(speed);
                    const double end = speed > 0 ? 1 : -0.5;
                    Scene scene;
                    scene.gravity = {0, gravity};
                    const BodyId slider = scene.add(bob({0, 0}, 4, 0.3)),
                                 arm = scene.add(bob({8, 0}, 4, 0.3));
                    scene.add(Joint{.b = slider,
                                    .kind = PrismaticJoint{.axis = {1, 0},
                                                           .lower = -0.5,
                                                           .upper = 1,
                                                           .motor_speed = speed,
                                                           .max_motor_force = force}});
                    scene.add(Joint{
                        .b = arm,
                        .kind = RevoluteJoint{
                            .lower = -0.5, .upper = 1, .motor_speed = speed, .max_motor_torque = force}});
                    BasicWorld<Real> world(scene);
                    for (int i = 0; i < 600; ++i) world.step(kStep);
                    CHECK(world.state(slider).position.x == doctest::Approx(end).epsilon(1e-5));
                    CHECK(std::fabs(world.state(slider).velocity.x) < 1e-5);
                    CHECK(world.state(arm).angle == doctest::Approx(end).epsilon(1e-5));
                    CHECK(std::fabs(world.state(arm).angular_velocity) < 1e-5);
                }
    }

    TEST_CASE("a slider goes down its axis with g sin, up to its end") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId b = scene.add(bob({1, 2}));
        scene.add(Joint{.b = b, .kind = PrismaticJoint{.axis = {4, -3}, .lower = 0, .upper = 2}});
        World world(scene);
        for (int i = 0; i < 30; ++i) world.step(kStep);
        const double way = 0.5 * 10 * 0.6 * 0.25;
        CHECK(world.state(b).position.x == doctest::Approx(1 + 0.8 * way).epsilon(1e-4));
        CHECK(world.state(b).position.y == doctest::Approx(2 - 0.6 * way).epsilon(1e-4));
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.state(b).position.x == doctest::Approx(1 + 0.8 * 2).epsilon(1e-4));
        CHECK(std::fabs(world.state(b).angle) < 1e-6);
    }

    TEST_CASE("a welded beam carries its moment at the wall") {
        Scene scene;
        scene.gravity = {0, -10};
        std::optional<BodyId> last;
        JointId wall;
        for (int i = 0; i < 4; ++i) {
            const BodyId b = scene.add(bar({i + 0.5, 0}, 1));
            const JointId weld =
                scene.add(Joint{.a = last, .b = b, .kind = WeldJoint{.anchor = Vec2{double(i), 0}}});
            if (!last) wall = weld;
            last = b;
        }
        World world(scene);
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.joint_force(wall).y == doctest::Approx(40).epsilon(1e-4));
        CHECK(world.joint_torque(wall) == doctest::Approx(40 * 2).epsilon(1e-4));
        CHECK(std::fabs(world.state(*last).position.y) < 1e-5);
    }

    TEST_CASE("a suspension sinks by g / w² under its load, to the share w h of its damping ratio") {
        Scene scene;
        scene.gravity = {0, -10};
        // The wheel is held; the car stands on the spring. Mass on the spring: 1 / (1/3 + 0).
        const BodyId wheel =
            scene.add({.type = BodyType::static_body, .shape = Disc{0.3}, .position = {0, 0}, .group = -1});
        const BodyId car = scene.add(bob({0, 0}, 3));
        scene.bodies[car.index].fixed_rotation = true;
        scene.add(Joint{.a = car, .b = wheel, .kind = WheelJoint{.frequency = 2, .damping_ratio = 0.2}});
        World world(scene);
        for (int i = 0; i < 600; ++i) world.step(kStep);
        const double w = 2 * kPi * 2;
        CHECK(world.state(car).position.y == doctest::Approx(-10 / (w * w)).epsilon(0.012));
        CHECK(std::fabs(world.state(car).position.x) < 1e-6);
    }

    TEST_CASE("a target pulls with its force at most, and holds what it has drawn") {
        Scene scene;
        const BodyId b = scene.add(bob({0, 0}, 2));
        const JointId drag =
            scene.add(Joint{.b = b, .kind = TargetJoint{.target = {10, 0}, .max_force = 4, .frequency = 5}});
        World world(scene);
        for (int i = 0; i < 30; ++i) world.step(kStep);
        CHECK(world.state(b).velocity.x == doctest::Approx(4.0 / 2 * 0.5).epsilon(1e-4));
        CHECK(world.joint_force(drag).x == doctest::Approx(4).epsilon(1e-4));
        world.set_target(drag, {0.5, 1});
        for (int i = 0; i < 1200; ++i) world.step(kStep);
        CHECK(world.state(b).position.x == doctest::Approx(0.5).epsilon(1e-3));
        CHECK(world.state(b).position.y == doctest::Approx(1).epsilon(1e-3));
    }

    TEST_CASE("a rope is slack until it is taut") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId b = scene.add(bob({0.5, 0}));
        const JointId rope = scene.add(Joint{.b = b, .kind = DistanceJoint{.max = 1}});
        World world(scene);
        world.step(kStep);
        CHECK(world.joint_force(rope) == Vec2{0, 0});
        double longest = 0;
        for (int i = 0; i < 600; ++i) {
            world.step(kStep);
            const Vec2 at = world.state(b).position;
            longest = std::max(longest, std::hypot(at.x, at.y));
        }
        CHECK(longest < 1.002);
        CHECK(longest > 0.999);
    }

    TEST_CASE("a joint breaks beyond its force and not below it") {
        for (const double limit : {19.0, 21.0}) {
            CAPTURE(limit);
            Scene scene;
            scene.gravity = {0, -10};
            const BodyId b = scene.add(bob({0, -1}, 2));
            const JointId rod = scene.add(Joint{.b = b, .kind = DistanceJoint{}, .break_force = limit});
            World world(scene);
            world.step(kStep);
            CHECK(world.is_alive(rod) == (limit > 20));
            CHECK(world.broken_joints().size() == (limit > 20 ? 0u : 1u));
            const std::span<const JointBreak> breaks = world.events().breaks;
            REQUIRE(breaks.size() == (limit > 20 ? 0u : 1u));
            for (const JointBreak& each : breaks) {
                CHECK(each.joint == rod);
                CHECK(each.a == BodyId{});
                CHECK(each.b == b);
                CHECK(each.time == world.time());
                CHECK(each.point.y == doctest::Approx(-1).epsilon(0.01));
                CHECK(each.force.y == doctest::Approx(20).epsilon(0.01));
            }
            world.step(kStep);
            CHECK(world.events().breaks.empty());
            CHECK(world.broken_joints().empty());
            for (int i = 0; i < 30; ++i) world.step(kStep);
            CHECK((world.state(b).position.y < -1.1) == (limit < 20));
        }
    }

    TEST_CASE("the ledger books the work of springs and motors to joints and explains the rest") {
        Scene scene = every_joint();
        World world(scene, {.effects = {.ledger = true}});
        for (int i = 0; i < 240; ++i) world.step(kStep);
        const Ledger ledger = world.ledger();
        const double scale = std::fabs(ledger.initial.total()) + std::fabs(ledger.energy_by_cause.joints);
        CHECK(ledger.energy_by_cause.joints != 0);
        CHECK(std::fabs(ledger.energy_by_cause.unexplained) < 1e-4 * scale);
        CHECK(std::hypot(ledger.momentum_by_cause.unexplained.x, ledger.momentum_by_cause.unexplained.y) <
              1e-3 * std::hypot(ledger.momentum_by_cause.gravity.x, ledger.momentum_by_cause.gravity.y));
    }
}

}  // namespace test_joints

// Solver `rattle` against exact mechanics: A3, A17, A23, A24 of docs/exact-cases.md, B22 of
// docs/hard-cases.md.
#include "support/joints.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <doctest/doctest.h>

namespace test_rattle {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kPi = std::numbers::pi;

/// Largest error of the energy in a number of steps, over m g l of one bob [no unit].
template <class Real>
double worst_energy(const Scene& scene, int steps, int substeps) {
    BasicWorld<Real> world(scene, {.solver = Solver::rattle, .substeps = substeps});
    const double start = world.ledger().energy.total();
    double worst = 0;
    for (int i = 0; i < steps; ++i) {
        world.step(kStep);
        worst = std::max(worst, std::fabs(world.ledger().energy.total() - start) / 10);
    }
    return worst;
}

}  // namespace

TEST_SUITE("physics: rattle") {
    TEST_CASE("a pendulum from 90° keeps its energy to second order of the substep") {
        const double one = worst_energy<double>(rod_pendulum(kPi / 2), 1200, 1),
                     two = worst_energy<double>(rod_pendulum(kPi / 2), 1200, 2),
                     four = worst_energy<double>(rod_pendulum(kPi / 2), 1200, 4);
        CHECK(one < 1.5e-3);
        CHECK(std::log2(one / two) == doctest::Approx(2).epsilon(0.05));
        CHECK(std::log2(two / four) == doctest::Approx(2).epsilon(0.05));
    }

    TEST_CASE_TEMPLATE("A23: its period is that of the elliptic integral", Real, float, double) {
        BasicWorld<Real> world(rod_pendulum(kPi / 2), {.solver = Solver::rattle});
        double before = 1, first = -1, last = -1;
        int crossings = 0;
        for (int i = 1; i <= 1200; ++i) {
            world.step(kStep);
            const double now = world.bodies().position_x[0];
            if (before > 0 && now <= 0) {
                last = (i - now / (now - before)) * kStep;
                if (first < 0) first = last;
                ++crossings;
            }
            before = now;
        }
        CHECK((last - first) / (crossings - 1) ==
              doctest::Approx(1.180341 * 2 * kPi * std::sqrt(0.1)).epsilon(5e-4));
        CHECK(world.plan().solver == "rattle");
    }

    TEST_CASE("B22: a pendulum does not drift in many swings") {
        // A million steps take 4 s of a core: docs/decisions/0029-rattle.md has them; here a tenth.
        World64 world(rod_pendulum(kPi / 2), {.solver = Solver::rattle});
        const double start = world.ledger().energy.total();
        const auto mean_of = [&](int steps) {
            double sum = 0;
            for (int i = 0; i < steps; ++i) world.step(kStep), sum += world.ledger().energy.total() - start;
            return sum / steps / 10;
        };
        const double early = mean_of(10'000);
        for (int i = 0; i < 80'000; ++i) world.step(kStep);
        CHECK(std::fabs(mean_of(10'000) - early) < 1e-6);
        CHECK(world.joint_errors().max < 1e-12);
    }

    TEST_CASE_TEMPLATE("A24: a double pendulum and a dumbbell keep what they have", Real, float, double) {
        Scene pair;
        pair.gravity = {0, -10};
        const BodyId a = pair.add(bob({1, 0})), b = pair.add(bob({2, 0}));
        pair.add(Joint{.b = a, .kind = DistanceJoint{}});
        pair.add(Joint{.a = a, .b = b, .kind = DistanceJoint{}});
        CHECK(worst_energy<Real>(pair, 600, 4) < 4e-3);
        Scene dumbbell;
        const BodyId left = dumbbell.add(bob({-0.5, 0})), right = dumbbell.add(bob({0.5, 0}));
        dumbbell.bodies[0].velocity = {0, -2.5}, dumbbell.bodies[1].velocity = {0, 2.5};
        const JointId rod = dumbbell.add(Joint{.a = left, .b = right, .kind = DistanceJoint{}});
        BasicWorld<Real> world(dumbbell, {.solver = Solver::rattle});
        for (int i = 0; i < 10'000; ++i) world.step(kStep);
        CHECK(world.ledger().energy.total() == doctest::Approx(6.25).epsilon(1e-4));
        const Vec2 force = world.joint_force(rod);
        CHECK(std::hypot(force.x, force.y) == doctest::Approx(12.5).epsilon(2e-3));
    }

    TEST_CASE("A3: springs and motors that hold nothing act as under soft") {
        // A spring alone, a motor on a hinge, a slider on a spring: what is held lacks nothing, so a solver
        // that looked at that alone would leave them still.
        Scene scene;
        const BodyId mass = scene.add(bob({1.25, 0}));
        scene.add(Joint{.b = mass, .kind = DistanceJoint{.length = 1, .frequency = 3}});
        const BodyId wheel = scene.add(bob({5, 0}));
        scene.add(Joint{.b = wheel, .kind = RevoluteJoint{.motor_speed = 6, .max_motor_torque = 0.01}});
        const BodyId slider = scene.add(bob({9, 0}));
        scene.bodies.back().velocity = {0, 2};
        scene.add(Joint{.b = slider, .kind = PrismaticJoint{.axis = {0, 1}, .frequency = 2}});
        World64 world(scene, {.solver = Solver::rattle});
        double off = 0, off_slider = 0;
        for (int i = 1; i <= 120; ++i) {
            world.step(kStep);
            off = std::max(
                off, std::fabs(world.state(mass).position.x - 1 - 0.25 * std::cos(2 * kPi * 3 * i * kStep)));
            off_slider = std::max(off_slider, std::fabs(world.state(slider).position.y -
                                                        2 / (4 * kPi) * std::sin(2 * kPi * 2 * i * kStep)));
            // 0.01 N m on 0.005 kg m².
            if (i == 60) CHECK(world.state(wheel).angular_velocity == doctest::Approx(2).epsilon(1e-6));
        }
        CHECK(off < 1e-6);
        CHECK(off_slider < 1e-3);
    }

    TEST_CASE("it solves what soft would sweep, and goes back to contacts when asked to") {
        Scene net = hanging_net(12);
        World64 world(net, {.solver = Solver::rattle});
        for (int i = 0; i < 30; ++i) world.step(kStep);
        CHECK(world.joint_errors().max < 1e-5);
        CHECK(world.plan().joints.find("swept") == std::string::npos);
        const double before = world.ledger().energy.total();
        world.set_solver(Solver::soft);
        CHECK(world.ledger().energy.total() == before);
        world.step(kStep);
        CHECK(world.plan().solver == "soft");
        CHECK(world.plan().joints.find("swept") != std::string::npos);
    }

    TEST_CASE("a mechanism that meets a floor is handed over to contacts, and the ledger explains it") {
        // A pendulum whose bob strikes a block at its lowest point, now and then: solver `auto`.
        Scene scene = rod_pendulum(kPi / 3);
        scene.bodies[0].group = 0;
        scene.add({.type = BodyType::static_body, .shape = Box{0.2, 0.2}, .position = {-0.21, -1}});
        scene.effects.ledger = true;
        World64 world(scene);
        for (int i = 0; i < 600; ++i) world.step(kStep);
        const Ledger books = world.ledger();
        CHECK(world.state({0, 0}).position.x > -0.02);
        CHECK(std::fabs(books.energy_by_cause.unexplained) < 1e-6);
        CHECK(world.joint_errors().max < 1e-6);
    }
}

}  // namespace test_rattle

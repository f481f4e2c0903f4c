// A4, A13, A14, A15 and A36 of docs/exact-cases.md for boxes: impacts of bodies that are no discs, whose
// normal need not pass through their centres, and their free flight.
#include "support/box_scenes.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_box_impacts {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kMass = 2;  // kg

Body free_box(Vec2 position, double width, double height, double angle, Vec2 velocity, double spin,
              double restitution, double friction) {
    return {.shape = Box{width, height},
            .position = position,
            .angle = angle,
            .velocity = velocity,
            .angular_velocity = spin,
            .mass = kMass,
            .material = {.friction = friction, .restitution = restitution}};
}

/// Two boxes that meet: a corner hits a side off its middle, and both spin.
Scene two_boxes(int number, double restitution, double friction) {
    const auto some = [&](int which) { return jitter_of(static_cast<std::uint64_t>(10 * number + which)); };
    Scene scene;
    scene.add(free_box({-2, 0.5 * some(0)}, 1, 0.6, 3 * some(1), {4 + some(2), some(3)}, 3 * some(4),
                       restitution, friction));
    scene.add(free_box({2, 0.5 * some(5)}, 1.5, 0.5, 3 * some(6), {-4 + some(7), some(8)}, 3 * some(9),
                       restitution, friction));
    scene.bodies[1].mass = 3 * kMass;
    return scene;
}

/// kg m², of a box of kMass.
double moment_of(double width, double height) {
    return kMass * (width * width + height * height) / 12;
}

}  // namespace

TEST_SUITE("physics/box impacts") {
    TEST_CASE("A14: boxes that meet keep their momentum to round-off and gain no energy") {
        double worst = 0, gain = 0;
        int met = 0;
        for (int number = 0; number < 100; ++number)
            for (const double restitution : {0.0, 0.5, 1.0})
                for (const double friction : {0.0, 0.6}) {
                    BoxRun<double> run(two_boxes(number, restitution, friction));
                    const Ledger before = run.world.ledger();
                    const double spin = run.spin(0);
                    run.steps(60);
                    const Ledger after = run.world.ledger();
                    met += run.spin(0) != spin;
                    worst = std::max({worst, std::fabs(after.momentum.x - before.momentum.x),
                                      std::fabs(after.momentum.y - before.momentum.y)});
                    gain = std::fmax(gain, after.energy.total() / before.energy.total() - 1);
                }
        report("A14: of 600 met ", met, "; momentum off by ", worst, " kg m/s, energy up by ", gain);
        CHECK(met > 500);
        CHECK(worst < 1e-14 * 3 * kMass * 5);
        CHECK(gain < 1e-14);
    }
    TEST_CASE_TEMPLATE("A14: elastic boxes without friction keep their energy", Real, float, double) {
        double worst = 0;
        for (int number = 0; number < 100; ++number) {
            BoxRun<Real> run(two_boxes(number, 1, 0));
            const double before = run.world.ledger().energy.total();
            run.steps(60);
            worst = std::fmax(worst, std::fabs(run.world.ledger().energy.total() / before - 1));
        }
        report("A14: energy of elastic boxes off by ", worst);
        CHECK(worst < (sizeof(Real) == sizeof(float) ? 4e-6 : 1e-14));
    }
    TEST_CASE_TEMPLATE("A14: boxes that bounce off each other keep their angular momentum to round-off", Real,
                       float, double) {
        // Both move and spin while they near each other: their points of contact do not stay where they were
        // found. Elastic and smooth they do not stay together either, so that there are impacts alone.
        double worst = 0;
        int met = 0;
        for (int number = 0; number < 100; ++number) {
            BoxRun<Real> run(two_boxes(number, 1, 0));
            const double before = run.world.ledger().angular_momentum, spin = run.spin(0);
            run.steps(60);
            met += run.spin(0) != spin;
            worst = std::fmax(worst, std::fabs(run.world.ledger().angular_momentum - before));
        }
        report("A14: of 100 met ", met, "; angular momentum off by ", worst, " kg m²/s");
        CHECK(met > 80);
        CHECK(worst < (sizeof(Real) == sizeof(float) ? 1e-4 : 1e-12));
    }
    TEST_CASE("A14: inelastic, rough impacts of boxes keep their angular momentum to round-off") {
        // In the step of the first impact. A few boxes go on to press on each other in it: as contacts, whose
        // points are those of the step's start.
        int met = 0, exact = 0;
        for (int number = 0; number < 100; ++number)
            for (const double friction : {0.0, 0.6}) {
                BoxRun<double> run(two_boxes(number, 0.5, friction));
                const double before = run.world.ledger().angular_momentum, spin = run.spin(0);
                for (int i = 0; i < 60 && run.spin(0) == spin; ++i) run.steps(1);
                if (run.spin(0) == spin) continue;
                ++met;
                exact += std::fabs(run.world.ledger().angular_momentum - before) < 1e-12;
            }
        report("A14: of 200 met ", met, ", kept angular momentum to 1e-12 ", exact);
        CHECK(met > 160);
        CHECK(exact > 0.98 * met);
    }
    TEST_CASE_TEMPLATE("A15: a box that hits another flat in line leaves as the impact formula says", Real,
                       float, double) {
        for (const double restitution : {0.5, 1.0})
            for (const double ratio : {0.1, 1.0, 20.0}) {
                CAPTURE(restitution);
                CAPTURE(ratio);
                Scene scene;
                scene.add(free_box({-1, 0}, 1, 1, 0, {3, 0}, 0, restitution, 0.5));
                scene.add(free_box({1, 0}, 0.5, 1, 0, {-1, 0}, 0, restitution, 0.5));
                scene.bodies[1].mass = ratio * kMass;
                BoxRun<Real> run(scene);
                run.steps(60);
                const double common = (3 - ratio) / (1 + ratio);
                const double rounding = sizeof(Real) == sizeof(float) ? 4e-6 : 4e-13;
                report("A15: ", run.velocity(0).x - (common - restitution * 4 * ratio / (1 + ratio)), " ",
                       run.velocity(1).x - (common + restitution * 4 / (1 + ratio)), " spin ", run.spin(0));
                CHECK(std::fabs(run.velocity(0).x - (common - restitution * 4 * ratio / (1 + ratio))) <
                      rounding);
                CHECK(std::fabs(run.velocity(1).x - (common + restitution * 4 / (1 + ratio))) < rounding);
                CHECK(std::fabs(run.spin(0)) < rounding);
                CHECK(std::fabs(run.spin(1)) < rounding);
            }
    }
    TEST_CASE_TEMPLATE("A13: a rod that meets the ground with a corner leaves with the impulse of its arm",
                       Real, float, double) {
        for (const double height : {0.1, 1.0})
            // The last angle has the corner below the centre: no arm.
            for (const double angle : {0.2, 0.7, 1.2, std::atan(1 / height)})
                for (const double restitution : {0.5, 1.0}) {
                    CAPTURE(angle);
                    CAPTURE(height);
                    CAPTURE(restitution);
                    Scene scene = box_ground(0);
                    scene.gravity = {};
                    const double c = std::cos(angle), s = std::sin(angle);
                    const double reach = 0.5 * (s + height * c), arm = -0.5 * (c - height * s);
                    scene.add(free_box({0, reach + 0.55}, 1, height, angle, {0.3, -5}, 0, restitution, 0));
                    BoxRun<Real> run(scene);
                    run.steps(7);  // the impact is at 0.11 s, one of the other corner later
                    const double moment = moment_of(1, height);
                    const double impulse = (1 + restitution) * 5 / (1 / kMass + arm * arm / moment);
                    const double rounding = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
                    report("A13: angle ", angle, ", height ", height, ": ",
                           run.velocity(1).y - (impulse / kMass - 5), " m/s, ",
                           run.spin(1) - arm * impulse / moment, " rad/s");
                    CHECK(std::fabs(run.velocity(1).y - (impulse / kMass - 5)) < rounding);
                    CHECK(std::fabs(run.velocity(1).x - 0.3) < rounding);
                    CHECK(std::fabs(run.spin(1) - arm * impulse / moment) < rounding);
                }
    }
    TEST_CASE_TEMPLATE("A13: a disc that hits a box off its centre turns it as the impulse formula says",
                       Real, float, double) {
        for (const double arm : {0.0, 0.2, -0.4})
            for (const double restitution : {0.5, 1.0}) {
                const double friction = 0;
                CAPTURE(arm);
                CAPTURE(restitution);
                Scene scene;
                scene.add(free_box({0, 0}, 0.5, 1, 0, {}, 0, restitution, friction));
                scene.add({.shape = Disc{0.2},
                           .position = {-1, arm},
                           .velocity = {6, 0},
                           .mass = 1.0,
                           .material = {.friction = friction, .restitution = restitution}});
                BoxRun<Real> run(scene);
                run.steps(8);  // the impact is at 0.092 s
                const double moment = moment_of(0.5, 1);
                const double impulse = (1 + restitution) * 6 / (1 + 1 / kMass + arm * arm / moment);
                const double rounding = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
                report("A13: arm ", arm, " e ", restitution, ": ", run.velocity(1).x - (6 - impulse),
                       " m/s, ", run.spin(0) + arm * impulse / moment, " rad/s");
                CHECK(std::fabs(run.velocity(1).x - (6 - impulse)) < rounding);
                CHECK(std::fabs(run.velocity(0).x - impulse / kMass) < rounding);
                CHECK(std::fabs(run.spin(0) + arm * impulse / moment) < rounding);
            }
    }
    TEST_CASE_TEMPLATE("A4: a box that is dropped flat bounces to e^2 of its height", Real, float, double) {
        for (const double restitution : {0.5, 0.8, 1.0}) {
            CAPTURE(restitution);
            Scene scene = box_ground(0.5);
            scene.add(free_box({0, 0.25 + 2}, 1, 0.5, 0, {}, 0, restitution, 0.5));
            BoxRun<Real> run(scene);
            double highest = 0;
            const double fall = std::sqrt(2 * 2 / kBoxGravity), rise = restitution * fall;
            for (int i = 0; i < static_cast<int>((fall + 1.9 * rise) * 60); ++i) {
                run.steps(1);
                if (i > fall * 60 + 1) highest = std::fmax(highest, run.place(1).y - 0.25);
            }
            report("A4: restitution ", restitution, ": rises to ", highest / (restitution * restitution * 2),
                   " of its height");
            CHECK(highest == doctest::Approx(restitution * restitution * 2).epsilon(0.02));
            CHECK(std::fabs(run.spin(1)) < 1e-3);
        }
    }
    TEST_CASE_TEMPLATE("A4: a box under drag that bounces is as fast as one that flies on, times e", Real,
                       float, double) {
        for (const double drag : {1.0, 20.0})
            for (const double restitution : {0.5, 1.0}) {
                CAPTURE(drag);
                CAPTURE(restitution);
                Scene scene;
                scene.accuracy.solver = Solver::soft;
                scene.drag = {.linear = drag, .angular = drag};
                Body wall{.type = BodyType::static_body, .shape = Box{1, 9}, .position = {1, 0}};
                wall.material.restitution = restitution;
                scene.add(wall);
                scene.add(free_box({0, 0}, 0.5, 0.5, 0, {20, 0}, 0, restitution, 0));
                BoxRun<Real> run(scene);
                run.steps(6);
                const double speed = run.world.state({1, 0}).velocity.x;
                CHECK(speed == doctest::Approx(-restitution * 20 * std::exp(-drag * 0.1)).epsilon(1e-5));
            }
    }
    TEST_CASE("A36: a box that spins freely turns by its rate times the time, for a million steps") {
        for (const double spin : {0.7, -13.0}) {
            Scene scene;
            scene.add(free_box({1, 2}, 3, 0.5, 0.25, {0.1, 0}, spin, 0, 0));
            BoxRun<double> run(scene);
            const int steps = scaled(1000000, 100000);
            run.steps(steps);
            const double turn = 0.25 + spin * steps / 60.0;
            report("A36: angle off by ", run.angle(0) / turn - 1, " of it");
            CHECK(run.angle(0) == doctest::Approx(turn).epsilon(1e-10));
            CHECK(run.spin(0) == spin);
        }
    }
}

}  // namespace test_box_impacts

// A8, A9, A12, A25, A29, A30 and A33 of docs/exact-cases.md, B15 and B40 of docs/hard-cases.md: what boxes
// and polygons do when they stand, slide, tip and lean, against Newton's and Coulomb's laws.
#include "support/box_scenes.hpp"
#include "support/effort.hpp"
#include "support/hard_case.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace test_boxes {

using namespace carom;
using namespace carom::test;

namespace {

/// A box that lies on a slope, which falls to the right by `slope` [rad], through the origin.
Scene box_on_slope(double slope, double width, double height, double friction) {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    const auto above = [&](double distance) {  // m, of a point from the slope
        return Vec2{distance * std::sin(slope), distance * std::cos(slope)};
    };
    scene.add({.type = BodyType::static_body,
               .shape = Box{200, 2},
               .position = above(-1),
               .angle = -slope,
               .material = {.friction = friction}});
    const Vec2 place = above(0.5 * height);
    scene.add(box_at(place.x, place.y, width, height, friction, -slope));
    return scene;
}

template <class Real>
double way_down(const BoxRun<Real>& run, double slope) {
    return (run.place(1).x - run.start(1).x) * std::cos(slope) -
           (run.place(1).y - run.start(1).y) * std::sin(slope);
}

constexpr double kLadderLength = 4, kLadderThickness = 0.05;  // m

/// A ladder at the angle `slope` to the ground, its upper end at a wall without friction, whose face is
/// x = 0.
Scene ladder(double slope, double friction) {
    Scene scene = box_ground(friction, 20);
    scene.add({.type = BodyType::static_body, .shape = Box{2, 20}, .position = {1, 10}});
    const double c = std::cos(slope), s = std::sin(slope);
    scene.add(box_at(-0.5 * (kLadderLength * c + kLadderThickness * s),
                     0.5 * (kLadderLength * s + kLadderThickness * c), kLadderLength, kLadderThickness,
                     friction, slope));
    return scene;
}

constexpr double kSpacing = 0.4;  // of dominoes, in heights

/// Dominoes of height `length`, a tenth as thick; the first leans beyond its balance.
Scene dominoes(int count, double length) {
    const double friction = 0.3, thick = 0.1 * length, spacing = kSpacing * length, lean = 0.15;
    Scene scene = box_ground(friction, 100 * length);
    for (int i = 0; i < count; ++i) {
        Body domino = box_at(i * spacing, 0.5 * length, thick, length, friction);
        if (i == 0) {  // turned about its lower right corner
            const double arm_x = -0.5 * thick, arm_y = 0.5 * length;
            domino.angle = -lean;
            domino.position = {0.5 * thick + arm_x * std::cos(lean) + arm_y * std::sin(lean),
                               arm_y * std::cos(lean) - arm_x * std::sin(lean)};
        }
        scene.add(domino);
    }
    return scene;
}

/// Speed of the wave from one domino to another, steps of `dt` [s], over sqrt(g length).
template <class Real>
double wave_speed(double length, double dt) {
    constexpr double kFalls = 0.1;  // rad, the angle at which a domino counts
    constexpr int kFrom = 20, kTo = 40;
    BoxRun<Real> run(dominoes(60, length));
    auto time_of = [&, time = 0.0](int domino) mutable {
        double before = 0, now = -run.angle(static_cast<std::size_t>(1 + domino));
        while (now <= kFalls && time < 60) {
            run.steps(1, dt);
            time += dt, before = now;
            now = -run.angle(static_cast<std::size_t>(1 + domino));
        }
        return time - dt * (now - kFalls) / (now - before);
    };
    const double start = time_of(kFrom);
    return kSpacing * (kTo - kFrom) / (time_of(kTo) - start) * std::sqrt(length / kBoxGravity);
}

}  // namespace

TEST_SUITE("physics/boxes") {
    TEST_CASE_TEMPLATE("A8: a box that slides from under 25 discs drags them as rolling says", Real, float,
                       double) {
        // There are no forces to pull it with, so gravity is tilted: in its frame the pull is zero.
        const double along = 9, mass = 10, disc_mass = 1, friction = 0.4;
        const int discs = 25;
        Scene scene = box_ground(friction);
        scene.gravity.x = along;
        scene.add(box_at(0, 0.5, 20, 1, friction));
        scene.bodies[1].mass = mass;
        for (int i = 0; i < discs; ++i)
            scene.add({.shape = Disc{0.1},
                       .position = {-9.0 + 0.6 * i, 1.1},
                       .mass = disc_mass,
                       .material = {.friction = 0.8 * 0.8 / friction}});
        BoxRun<Real> run(scene);
        run.steps(30);
        const double on_disc =
            -friction * (mass + discs * disc_mass) * kBoxGravity / mass / (3 / disc_mass + discs / mass);
        const double of_box = along + 3 * on_disc / disc_mass, of_discs = along + on_disc / disc_mass;
        report("A8: box ", run.velocity(1).x / (0.5 * of_box) - 1, ", disc ",
               run.velocity(14).x / (0.5 * of_discs) - 1);
        CHECK(run.velocity(1).x == doctest::Approx(0.5 * of_box).epsilon(1e-4));
        for (int i = 0; i < discs; ++i)
            CHECK(run.velocity(static_cast<std::size_t>(2 + i)).x ==
                  doctest::Approx(0.5 * of_discs).epsilon(1e-4));
        CHECK(std::fabs(run.angle(1)) < 1e-4);
    }
    TEST_CASE_TEMPLATE("A9: a box on a slope below the angle of friction does not creep in a minute", Real,
                       float, double) {
        for (const double slope : {0.1, 0.3, 0.5})
            for (const double share : {0.5, 0.99}) {
                CAPTURE(slope);
                CAPTURE(share);
                BoxRun<Real> run(box_on_slope(slope, 1, 0.5, std::tan(slope) / share));
                run.steps(scaled(3600, 600));
                report("A9: slope ", slope, ", ", share, ": moved ", run.farthest_shift());
                CHECK(run.farthest_shift() < 1e-6);
            }
    }
    TEST_CASE_TEMPLATE("A9: a box on a slope above the angle of friction slides as Coulomb says", Real, float,
                       double) {
        for (const double slope : {0.1, 0.3, 0.5})
            for (const double share : {1.01, 2.0}) {
                CAPTURE(slope);
                CAPTURE(share);
                const double friction = std::tan(slope) / share;
                BoxRun<Real> run(box_on_slope(slope, 1, 0.5, friction));
                run.steps(120);
                const double acceleration = kBoxGravity * (std::sin(slope) - friction * std::cos(slope));
                const double speed = std::hypot(run.velocity(1).x, run.velocity(1).y);
                report("A9: slope ", slope, ", ", share, ": speed off by ", speed / (2 * acceleration) - 1,
                       ", way by ", way_down(run, slope) / (2 * acceleration) - 1);
                CHECK(speed == doctest::Approx(2 * acceleration).epsilon(1e-4));
                CHECK(way_down(run, slope) == doctest::Approx(2 * acceleration).epsilon(1e-4));
                CHECK(std::fabs(run.angle(1) + slope) < 1e-3);
            }
    }
    TEST_CASE_TEMPLATE("A9: a box on a rough slope tips if the slope's tangent is above width over height",
                       Real, float, double) {
        for (const double width : {0.2, 0.5, 1.0}) {
            CAPTURE(width);
            const double low = std::atan(0.99 * width), high = std::atan(1.01 * width);
            BoxRun<Real> stands(box_on_slope(low, width, 1, 5)), tips(box_on_slope(high, width, 1, 5));
            stands.steps(1200), tips.steps(600);
            report("A9: width ", width, ": turned by ", stands.angle(1) + low, " and ", tips.angle(1) + high);
            CHECK(std::fabs(stands.angle(1) + low) < 1e-3);
            CHECK(tips.angle(1) + high < -0.5);
        }
    }
    TEST_CASE_TEMPLATE("A12: a box slides to a stop", Real, float, double) {
        for (const double friction : {0.1, 0.3, 0.8})
            for (const double speed : {1.0, 5.0}) {
                CAPTURE(friction);
                CAPTURE(speed);
                Scene scene = box_ground(friction, 200);
                scene.add(box_at(0, 0.25, 1, 0.5, friction));
                scene.bodies[1].velocity = {speed, 0};
                BoxRun<Real> run(scene);
                run.steps(600);
                const double way = speed * speed / (2 * friction * kBoxGravity);
                report("A12: friction ", friction, ", ", speed, " m/s: way off by ",
                       run.place(1).x / way - 1);
                CHECK(run.place(1).x == doctest::Approx(way).epsilon(0.005));
                CHECK(std::fabs(run.velocity(1).x) < 1e-6);
            }
    }
    TEST_CASE_TEMPLATE("A25: a block that slides down a free wedge drives it as momentum says", Real, float,
                       double) {
        for (const double mass : {0.5, 3.0}) {  // kg, of the block
            CAPTURE(mass);
            const double wedge_mass = 2, width = 4, height = 2, slope = std::atan(height / width);
            Scene scene = box_ground(0);
            scene.add({.shape = Polygon{{{0, 0}, {width, 0}, {0, height}}},
                       .position = {width / 3, height / 3},
                       .mass = wedge_mass,
                       .material = {.friction = 0}});
            const double s = std::sin(slope), c = std::cos(slope), side = 0.2;
            scene.add(
                box_at(1 + 0.5 * side * s, height - height / width + 0.5 * side * c, side, side, 0, -slope));
            scene.bodies[2].mass = mass;
            BoxRun<Real> run(scene);
            run.steps(30);
            const double acceleration = -mass * kBoxGravity * s * c / (wedge_mass + mass * s * s);
            report("A25: wedge off by ", run.velocity(1).x / (0.5 * acceleration) - 1, ", block ",
                   run.velocity(2).x / (-0.5 * acceleration * wedge_mass / mass) - 1);
            CHECK(run.velocity(1).x == doctest::Approx(0.5 * acceleration).epsilon(1e-4));
            CHECK(run.velocity(2).x ==
                  doctest::Approx(-0.5 * acceleration * wedge_mass / mass).epsilon(1e-4));
            CHECK(std::fabs(run.angle(1)) < 1e-3);
        }
    }
    TEST_CASE_TEMPLATE("A29: a ladder on a smooth wall stands if friction is half the cotangent of its angle",
                       Real, float, double) {
        for (const double slope : {0.7, 1.0, 1.3}) {
            CAPTURE(slope);
            // Its corners touch, so the weight is half a thickness nearer to the foot.
            const double least = 0.5 / std::tan(slope) - 0.5 * kLadderThickness / kLadderLength;
            BoxRun<Real> stands(ladder(slope, 1.03 * least)), falls(ladder(slope, 0.97 * least));
            stands.steps(scaled(1200, 600)), falls.steps(600);
            report("A29: angle ", slope, ": moved ", stands.farthest_shift(), " and ",
                   falls.farthest_shift());
            CHECK(stands.farthest_shift() < 1e-3);
            CHECK(falls.start(2).y - falls.place(2).y > 0.25);
        }
    }
    TEST_CASE_TEMPLATE("A29: two round-edged cards that lean on each other stand as ladders do", Real, float,
                       double) {
        for (const double slope : {0.7, 1.0, 1.3}) {
            CAPTURE(slope);
            const double length = 2, radius = 0.05, c = std::cos(slope), s = std::sin(slope);
            // About the point below: weight times half the length's shadow = push of the other card times
            // height.
            const double least = 0.5 * length * c / (length * s + radius);
            const auto cards = [&](double friction) {
                Scene scene = box_ground(friction, 20);
                for (const double side : {-1.0, 1.0})
                    scene.add({.shape = Capsule{length, radius},
                               .position = {side * (0.5 * length * c + radius), 0.5 * length * s + radius},
                               .angle = -side * slope,
                               .material = {.friction = friction}});
                return scene;
            };
            BoxRun<Real> stands(cards(1.03 * least)), falls(cards(0.97 * least));
            stands.steps(scaled(1200, 600)), falls.steps(600);
            report("A29: cards at ", slope, ": moved ", stands.farthest_shift(), " and ",
                   falls.farthest_shift());
            CHECK(stands.farthest_shift() < 1e-3);
            CHECK(falls.start(1).y - falls.place(1).y > 0.25);
        }
    }
    TEST_CASE_TEMPLATE("A30: an arch stands at a thickness of .115 of its radius and falls at .100", Real,
                       float, double) {
        check_cases<Real>(torture::arches(extent()));
    }
    TEST_CASE_TEMPLATE("B15: a card house moves by less than 1 % of a card in ten seconds", Real, float,
                       double) {
        check_cases<Real>(torture::card_houses(extent()));
    }
    TEST_CASE_TEMPLATE("A33: a wave of dominoes runs at one speed over sqrt(g l) at three sizes", Real, float,
                       double) {
        for (const int rate : scaled<std::vector<int>>({60, 240}, {60})) {  // steps a second
            double slowest = 1e9, fastest = 0;
            for (const double length : {0.5, 1.0, 2.0}) {
                const double speed = wave_speed<Real>(length, 1.0 / rate);
                report("A33: ", rate, " steps a second, height ", length, " m: v / sqrt(g l) ", speed);
                slowest = std::fmin(slowest, speed), fastest = std::fmax(fastest, speed);
            }
            CHECK(slowest > 0);
            CHECK(fastest < (rate == 60 ? 1.03 : 1.01) * slowest);
        }
    }
}

}  // namespace test_boxes

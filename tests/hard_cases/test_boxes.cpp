// B1, B2, B4, B6, B8, B9, B20, B25, B30 and B40 of docs/hard-cases.md, A28 of docs/exact-cases.md: what is
// built of boxes stands where it should and falls where it must.
#include "support/box_scenes.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/boxes") {
    TEST_CASE_TEMPLATE("a tower of 20 boxes, each a little aside, stands for a minute and comes to rest",
                       Real, float, double) {
        for (const std::uint64_t seed : {1u, 77u}) {
            BoxRun<Real> run(tower(20, 0.02, seed));
            run.steps(600);
            CHECK(run.rms_speed() < 1e-3);
            run.steps(scaled(3000, 300));
            CHECK(run.rms_speed() < 1e-3);
            CHECK(run.farthest_shift() < 0.02);
            CHECK(run.start(run.last()).y - run.place(run.last()).y < 0.001 * 20);
        }
    }
    TEST_CASE_TEMPLATE("a tower of 40 boxes, each a little aside, stands for a minute and comes to rest",
                       Real, float, double) {
        BoxRun<Real> run(tower(40, 0.02, 77));
        run.steps(scaled(3600, 900));
        CHECK(run.rms_speed() < 1e-3);
        CHECK(run.farthest_shift() < 0.02);
        CHECK(run.start(run.last()).y - run.place(run.last()).y < 0.001 * 40);
    }
    TEST_CASE_TEMPLATE("towers that stand or collapse make no energy", Real, float, double) {
        // One of a hundred that stands; one of 330 whose boxes fall on each other and buckle.
        for (const bool collapses : {false, true}) {
            CAPTURE(collapses);
            Scene scene = box_ground(0.5);
            scene.effects.ledger = true;
            const int count = collapses ? scaled(330, 100) : 100;
            for (int i = 0; i < count; ++i) scene.add(box_at(0, 0.5 + (collapses ? 1.4 : 1) * i, 1, 1, 0.5));
            BoxRun<Real> run(scene);
            const double before = run.world.ledger().energy.total();
            double most = before;
            for (int i = 0; i < 600; ++i) {
                run.steps(1);
                most = std::fmax(most, run.world.ledger().energy.total());
            }
            CHECK(most <= before * (1 + 1e-3));
            if (!collapses) CHECK(run.farthest_shift() < 0.1);  // 0.1 % of its height
        }
    }
    TEST_CASE("a tower that stands falls asleep within three seconds") {
        Scene scene = tower(20, 0.02, 5);
        scene.effects.sleep = true;
        BoxRun<float> run(scene);
        run.steps(180);
        CHECK(run.world.profile().asleep == 20);
    }
    TEST_CASE_TEMPLATE("a pyramid of 210 boxes comes to rest and keeps its height", Real, float, double) {
        BoxRun<Real> run(box_pyramid(20));
        run.steps(60);
        const double top = run.start(run.last()).y;
        run.mark();
        run.steps(540);
        CHECK(run.rms_speed() < 1e-3);
        CHECK(run.farthest_shift() < 0.03);
        CHECK(top - run.place(run.last()).y < 0.001 * 20);
    }
    TEST_CASE("a pyramid of 5,050 boxes comes to rest and keeps its height") {
        const int base = scaled(100, 40);
        BoxRun<float> run(box_pyramid(base));
        run.steps(60);
        const double top = run.start(run.last()).y;
        run.mark();
        run.steps(240);
        CHECK(run.rms_speed() < 1e-3);
        run.steps(300);
        CHECK(run.rms_speed() < 1e-3);
        CHECK(run.farthest_shift() < 0.03);
        CHECK(top - run.place(run.last()).y < 0.001 * base);
    }
    TEST_CASE_TEMPLATE("a box carries one that is a million times heavier", Real, float, double) {
        for (const double ratio : {10.0, 1e2, 1e3, 1e4, 1e6}) {
            CAPTURE(ratio);
            Scene scene = box_ground(0.6);
            scene.add(box_at(0, 0.5, 1, 1, 0.6));
            Body heavy = box_at(0, 1.5, 1, 1, 0.6);
            heavy.mass = ratio;
            scene.add(heavy);
            BoxRun<Real> run(scene);
            run.steps(600);
            CHECK(run.start(2).y - run.place(2).y < 0.01);  // of a side of 1 m
            CHECK(std::fabs(run.place(2).x) < 0.01);
        }
    }
    TEST_CASE_TEMPLATE("five boxes carry one of a thousand times their mass", Real, float, double) {
        Scene scene = tower(5, 0, 0);
        Body heavy = box_at(0, 5.5, 1, 1, 0.6);
        heavy.mass = 1000;
        scene.add(heavy);
        BoxRun<Real> run(scene);
        run.steps(600);
        CHECK(run.start(run.last()).y - run.place(run.last()).y < 0.01);
    }
    TEST_CASE_TEMPLATE("overhangs stand at .99 of the harmonic limit and fall at 1.01", Real, float, double) {
        for (const int blocks : {5, 10, 20}) {
            CAPTURE(blocks);
            BoxRun<Real> stands(overhang(blocks, 0.99)), falls(overhang(blocks, 1.01));
            stands.steps(1200), falls.steps(1200);
            CHECK(stands.farthest_shift() < 1e-3);
            CHECK(falls.start(falls.last()).y - falls.place(falls.last()).y > 0.2);
        }
    }
    TEST_CASE_TEMPLATE("boxes deep in each other part without speed", Real, float, double) {
        for (const double overlap : {0.25, 0.5, 0.9}) {
            CAPTURE(overlap);
            Scene scene = box_ground(0.6);
            scene.add(box_at(0, 0.5, 1, 1, 0.6));
            scene.add(box_at(0, 1.5 - overlap, 1, 1, 0.6));
            BoxRun<Real> run(scene);
            double fastest = 0;
            for (int i = 0; i < 120; ++i) {
                run.steps(1);
                fastest = std::fmax(fastest, std::hypot(run.velocity(2).x, run.velocity(2).y));
            }
            CHECK(fastest < 3);
            run.steps(600);
            const Vec2 between{run.place(2).x - run.place(1).x, run.place(2).y - run.place(1).y};
            CHECK(std::fmax(std::fabs(between.x), std::fabs(between.y)) > 0.99);
            CHECK(run.rms_speed() < 1e-3);
        }
    }
    TEST_CASE_TEMPLATE("a box on 1,000 small ones presses on the ground with its weight", Real, float,
                       double) {
        // A slab on a row of small boxes: more contacts on it than there are colours.
        const int count = scaled(1000, 200);
        Scene scene = box_ground(0.6, 2.0 * count);
        for (int i = 0; i < count; ++i) scene.add(box_at(1.2 * (i - 0.5 * (count - 1)), 0.5, 1, 1, 0.6));
        scene.add(box_at(0, 6, 1.2 * count, 10, 0.6));
        BoxRun<Real> run(scene);
        run.steps(300);
        CHECK(run.rms_speed() < 1e-3);
        CHECK(run.start(run.last()).y - run.place(run.last()).y < 0.01);
        CHECK(std::fabs(run.angle(run.last())) < 1e-4);
    }
    TEST_CASE_TEMPLATE(
        "a rod that slides on its tip with friction above 4/3 stays finite and gains no energy", Real, float,
        double) {
        // Painlevé: rigid bodies with this much friction have no acceleration; velocities always exist.
        for (const double friction : {1.4, 2.0, 5.0})
            for (const double angle : {0.4, 0.8, 1.2}) {
                CAPTURE(friction);
                CAPTURE(angle);
                Scene scene = box_ground(friction);
                const double reach = 0.5 * (std::sin(angle) + 0.02 * std::cos(angle));
                Body rod = box_at(0, reach, 1, 0.02, friction, angle);
                rod.velocity = {-5, 0};
                scene.add(rod);
                scene.effects.ledger = true;
                BoxRun<Real> run(scene);
                const double before = run.world.ledger().energy.total();
                double most = before;
                for (int i = 0; i < 180; ++i) {
                    run.steps(1);
                    most = std::fmax(most, run.world.ledger().energy.total());
                }
                CHECK(std::isfinite(run.place(1).x));
                CHECK(most <= before + 1e-3 * std::fabs(before) + 1e-4);
            }
    }
    TEST_CASE_TEMPLATE("boxes that do not turn pile up and rest without friction: nothing turns", Real, float,
                       double) {
        Scene scene = box_ground(0);
        scene.walls = Walls{.min = {-3, -20}, .max = {3, 40}};
        for (int i = 0; i < 60; ++i) {
            Body box = box_at(-2.5 + 0.9 * (i % 6), 0.6 + 0.95 * (i / 6), 0.8, 0.8, 0);
            box.fixed_rotation = true;
            scene.add(box);
        }
        BoxRun<Real> run(scene);
        run.steps(600);
        CHECK(run.rms_speed() < 1e-3);
        CHECK(run.world.overlaps().max < 0.03);
    }
    TEST_CASE_TEMPLATE("a rod of 2 m and 2 cm that turns at 100 rad/s misses no peg, round or flat", Real,
                       float, double) {
        int missed = 0;
        for (int shot = 0; shot < scaled(2000, 200); ++shot) {
            const auto draw = [&](int number, double low, double high) {
                return low +
                       0.5 * (high - low) * (1 + jitter_of(static_cast<std::uint64_t>(8 * shot + number)));
            };
            const double distance = draw(0, 0.1, 0.95), place = draw(1, -3, 3);
            Scene scene;
            Body peg{.type = BodyType::static_body,
                     .position = {distance * std::cos(place), distance * std::sin(place)}};
            if (shot % 2 == 0)
                peg.shape = Disc{0.03};
            else
                peg.shape = Segment{{0, -0.03}, {0, 0.03}};
            scene.add(peg);
            // It turns by 1.67 rad in the step, and the peg is up to 1.4 rad away.
            scene.add({.shape = Box{2, 0.02}, .angle = place + draw(2, 0.2, 1.4), .angular_velocity = -100});
            BoxRun<Real> run(scene);
            run.steps(1);
            missed += std::fabs(run.spin(1) + 100) < 1;
        }
        CHECK(missed == 0);
    }
    TEST_CASE_TEMPLATE("B6: small boxes heap up on and beside one that is a thousand times larger", Real,
                       float, double) {
        const double small = 0.1, large = 1000 * small, friction = 0.5;
        Scene scene = box_ground(friction, 20 * large);
        scene.add(box_at(0, 0.5 * large, large, large, friction));
        const auto add = [&](double x, double y) {
            const double angle = 0.3 * jitter_of(scene.bodies.size());
            scene.add(box_at(x, y, small, small, friction, angle));
        };
        for (int i = 0; i < 200; ++i) add(0.15 * (i % 20), large + 0.2 + 0.3 * (i / 20));
        for (int i = 0; i < 100; ++i) add(0.5 * large + 0.2 + 0.15 * (i % 10), 0.2 + 0.3 * (i / 10));
        BoxRun<Real> run(scene);
        run.steps(400);  // some boxes slide down late
        double lowest_on = large, lowest_beside = large;
        for (std::size_t i = 2; i <= run.last(); ++i) {
            const Vec2 at = run.place(i);
            double& lowest = std::fabs(at.x) < 0.5 * large ? lowest_on : lowest_beside;
            lowest = std::fmin(lowest, std::fabs(at.x) < 0.5 * large ? at.y - large : at.y);
        }
        const OverlapReport overlaps = run.world.overlaps();
        report("B6: boxes overlap by ", overlaps.max, " at most; lowest ", lowest_on, " m on the large one, ",
               lowest_beside, " m beside; it moved by ",
               std::fabs(run.place(1).x) + std::fabs(run.place(1).y - 0.5 * large));
        CHECK(overlaps.max < 0.1);
        CHECK(lowest_on > 0.45 * small);
        CHECK(lowest_beside > 0.45 * small);
        CHECK(run.rms_speed() < 1e-2);
    }
    TEST_CASE_TEMPLATE("a disc between a heavy box and a post is never expelled", Real, float, double) {
        Scene scene = box_ground(0.5);
        scene.add({.type = BodyType::static_body,
                   .shape = Box{1, 4},
                   .position = {5.5, 2},
                   .material = {.friction = 0.5}});
        scene.add({.shape = Disc{0.25}, .position = {4.7, 0.25}, .material = {.friction = 0.5}});
        Body heavy = box_at(2, 1, 2, 2, 0.5);
        heavy.mass = 1000, heavy.velocity = {8, 0};
        scene.add(heavy);
        BoxRun<Real> run(scene);
        double fastest = 0;
        for (int i = 0; i < 600; ++i) {
            run.steps(1);
            fastest = std::fmax(fastest, std::hypot(run.velocity(2).x, run.velocity(2).y));
        }
        CHECK(fastest < 1.05 * std::sqrt(8 * 8 + 2 * kBoxGravity * 1));
        CHECK(run.place(2).x > run.place(3).x);
        CHECK(run.place(2).x < 5);
    }
}

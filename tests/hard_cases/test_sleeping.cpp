// Sleeping by islands, and B24 of docs/hard-cases.md: bodies that come and go while part of a pile sleeps.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

namespace test_sleeping {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

Body rough_disc(double radius, Vec2 position, Vec2 velocity = {}) {
    Body body = disc(radius, radius * radius, position, velocity);
    body.material.friction = 0.5;
    return body;
}

/// Discs over a floor between x = from and x = from + width, in rows, a little apart.
void add_heap(Scene& scene, double from, double width, int count, unsigned seed) {
    std::mt19937 random(seed);
    const auto unit = [&] { return static_cast<double>(random() % 10000) / 10000; };
    const int a_row = static_cast<int>(width / 1.1);
    for (int i = 0; i < count; ++i)
        scene.add(rough_disc(0.4 + 0.1 * unit(), {from + 0.55 + 1.1 * (i % a_row) + 0.05 * unit(),
                                                  0.6 + 1.1 * static_cast<double>(i / a_row)}));
}

Scene box(double width, bool sleeps = true) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {width, 1000}, .material = {.friction = 0.5}};
    if (sleeps) scene.effects.sleep = true;
    return scene;
}

Scene pile(bool sleeps = true, int count = 100) {
    Scene scene = box(11, sleeps);
    add_heap(scene, 0, 11, count, 3);
    return scene;
}

/// Steps until all bodies sleep. @return how many steps that took, or `most`.
template <class Real>
int sleep_all(BasicWorld<Real>& world, int most = 3000) {
    for (int step = 0; step < most; ++step) {
        if (world.profile().asleep == static_cast<std::int64_t>(world.body_count())) return step;
        world.step(kStep);
    }
    return most;
}

template <class Real>
double fastest(const BasicWorld<Real>& world) {
    const auto bodies = world.bodies();
    double fastest = 0;
    for (std::size_t row = 0; row < bodies.count; ++row)
        fastest = std::fmax(fastest, std::hypot(bodies.velocity_x[row], bodies.velocity_y[row]));
    return fastest;
}

template <class Real>
BodyId highest(const BasicWorld<Real>& world) {
    const auto bodies = world.bodies();
    const auto y = bodies.position_y;
    return bodies.id[static_cast<std::size_t>(std::max_element(y.begin(), y.end()) - y.begin())];
}

}  // namespace

TEST_SUITE("hard cases/sleeping") {
    TEST_CASE_TEMPLATE("a pile falls asleep within ten seconds, and then nothing changes any more", Real,
                       float, double) {
        BasicWorld<Real> world(pile());
        const int steps = sleep_all(world);
        report("asleep after ", steps, " steps, islands ", world.profile().islands_asleep);
        CHECK(steps < 600);
        CHECK(fastest(world) == 0);
        const std::uint64_t hash = world.state_hash();
        const Profile before = world.profile();
        for (int i = 0; i < 100; ++i) world.step(kStep);
        CHECK(world.state_hash() == hash);
        CHECK(world.profile().asleep == 100);
        CHECK(world.profile().islands_asleep == before.islands_asleep);
        CHECK(world.time() == doctest::Approx((steps + 100) * kStep));
        CHECK(world.overlaps().max < 0.06);
        CHECK(world.overlaps().touching > 100);
    }

    TEST_CASE_TEMPLATE("asked for or not makes no difference while nothing is slow", Real, float, double) {
        Scene on = gas_scene({.count = 300, .packing_fraction = 0.4});
        on.accuracy.solver = Solver::soft;
        Scene off = on;
        on.effects.sleep = true;
        BasicWorld<Real> sleeps(on), never(off);
        for (int i = 0; i < 200; ++i) sleeps.step(kStep), never.step(kStep);
        CHECK(sleeps.state_hash() == never.state_hash());
        CHECK(sleeps.profile().asleep == 0);
    }

    TEST_CASE_TEMPLATE("a disc that hits a sleeping pile wakes it and is stopped as if it had been awake",
                       Real, float, double) {
        BasicWorld<Real> world(pile());
        REQUIRE(sleep_all(world) < 3000);
        const BodyId top = highest(world);
        const Vec2 place = world.state(top).position;
        const BodyId ball = world.add(rough_disc(0.5, {place.x, place.y + 3}, {0, -5}));
        CHECK(world.profile().asleep == 100);  // it is not there yet
        double before = 0;
        int steps = 0;
        for (; world.is_asleep(top) && steps < 100; ++steps) {
            before = world.state(ball).velocity.y;
            world.step(kStep);
        }
        CHECK(steps < 60);
        CHECK(before < -5);
        CHECK(world.profile().islands_woken > 0);
        // Whoever might be hit wakes before the step that hits: the ball is stopped as by a pile that was
        // awake.
        for (int i = 0; i < 3; ++i) {
            world.step(kStep);
            CHECK(world.overlaps().max < 0.1);
        }
        CHECK(world.state(ball).velocity.y > 0.5 * before);
        REQUIRE(sleep_all(world) < 3000);
        CHECK(world.profile().asleep == 101);
    }

    // Without gravity bodies that touch are islands of their own: those behind the first one slept on and
    // took what hit them as walls do.
    TEST_CASE_TEMPLATE("rows that sleep without gravity take no momentum from what hits them", Real, float,
                       double) {
        for (const double gap : {0.0, 0.01, 0.2})  // m
            for (const bool are_boxes : {false, true}) {
                CAPTURE(gap);
                CAPTURE(are_boxes);
                constexpr double kSide = 0.4, kSpeed = 40;  // m, m/s
                Scene scene;
                scene.effects.sleep = true;
                const auto add = [&](Vec2 place, Vec2 velocity, double mass) {
                    Body body{.position = place, .velocity = velocity, .mass = mass};
                    body.shape = are_boxes ? Shape{Box{kSide, kSide}} : Shape{Disc{kSide / 2}};
                    body.material.friction = 0.6;
                    return scene.add(std::move(body));
                };
                const BodyId bullet = add({-50, 0}, {kSpeed, 0}, 8);
                for (int i = 0; i < 60; ++i) add({(kSide + gap) * i, 0}, {}, 1);
                BasicWorld<Real> world(scene);
                while (world.state(bullet).position.x < -2) world.step(kStep);
                REQUIRE(world.profile().asleep == 60);
                for (int i = 0; i < 20; ++i) {
                    world.step(kStep);
                    CHECK(world.ledger().momentum.x == doctest::Approx(8 * kSpeed).epsilon(1e-4));
                }
                CHECK(world.ledger().energy.kinetic < 0.5 * 8 * kSpeed * kSpeed);
                CHECK(world.profile().asleep < 60);
            }
    }

    TEST_CASE_TEMPLATE("a pile that wakes does not jump", Real, float, double) {
        BasicWorld<Real> world(pile());
        REQUIRE(sleep_all(world) < 3000);
        world.set_velocity(highest(world), {0, 0});  // wakes its island
        CHECK(world.profile().asleep < 100);
        double jump = 0;
        for (int i = 0; i < 25; ++i) {
            world.step(kStep);
            jump = std::fmax(jump, fastest(world));
        }
        report("after waking at most ", jump, " m/s");
        CHECK(jump < 0.1);
    }

    TEST_CASE_TEMPLATE("of two piles one is woken and the other sleeps on", Real, float, double) {
        Scene scene = box(60);
        add_heap(scene, 0, 11, 20, 5);
        add_heap(scene, 40, 11, 20, 6);
        for (Body& body : scene.bodies) body.material.rolling_resistance = 0.1;  // else some roll for ever
        scene.walls->material.rolling_resistance = 0.1;
        BasicWorld<Real> world(scene);
        REQUIRE(sleep_all(world) < 3000);
        const std::int64_t islands = world.profile().islands_asleep;
        CHECK(islands >= 2);
        world.set_velocity({0, 0}, {0, 3});
        CHECK_FALSE(world.is_asleep({0, 0}));
        for (int i = 0; i < 20; ++i) world.step(kStep);
        for (std::uint32_t body = 20; body < 40; ++body) CHECK(world.is_asleep({body, 0}));
        CHECK(sleep_all(world) < 3000);
    }

    TEST_CASE_TEMPLATE("what lies on a body wakes and falls when the body is removed or put elsewhere", Real,
                       float, double) {
        for (const bool is_removed : {true, false}) {
            Scene scene = box(30);
            scene.add({.type = BodyType::static_body,
                       .shape = Disc{2},
                       .position = {10, 3},
                       .material = {.friction = 0.5}});
            scene.add(rough_disc(0.5, {10, 5.5}));
            scene.add(rough_disc(0.5, {25, 0.5}));
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 200; ++i) world.step(kStep);
            REQUIRE(world.is_asleep({1, 0}));
            REQUIRE(world.is_asleep({2, 0}));
            if (is_removed)
                world.remove({0, 0});
            else
                world.set_position({0, 0}, {15, 3});
            CHECK_FALSE(world.is_asleep({1, 0}));
            CHECK(world.is_asleep({2, 0}));
            for (int i = 0; i < 30; ++i) world.step(kStep);
            CHECK(world.state({1, 0}).velocity.y == doctest::Approx(-5).epsilon(1e-3));
            CHECK(world.is_asleep({2, 0}));
        }
    }

    TEST_CASE_TEMPLATE("a kinematic body wakes what it moves into, and no body sleeps on one that moves",
                       Real, float, double) {
        Scene scene = box(40);
        scene.add({.type = BodyType::kinematic_body, .shape = Disc{1}, .position = {3, 1}});
        scene.add(rough_disc(0.5, {10, 0.5}));
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        REQUIRE(world.is_asleep({1, 0}));
        world.set_velocity({0, 0}, {2, 0});
        CHECK(world.is_asleep({1, 0}));
        for (int i = 0; i < 200; ++i) world.step(kStep);
        CHECK_FALSE(world.is_asleep({1, 0}));
        const double gap = world.state({1, 0}).position.x - world.state({0, 0}).position.x;
        CHECK(gap > 1.2);  // it is pushed along: in front of the disc, on the floor
        CHECK(world.state({1, 0}).position.x > 11);

        Scene turning = box(40);
        turning.add({.type = BodyType::kinematic_body, .shape = Disc{3}, .position = {20, 3}});
        turning.bodies[0].angular_velocity = 1e-4;
        turning.add(disc(0.5, 1, {20, 6.5}));  // smooth: it stays on top
        BasicWorld<Real> other(turning);
        for (int i = 0; i < 200; ++i) other.step(kStep);
        CHECK_FALSE(other.is_asleep({1, 0}));
    }

    TEST_CASE_TEMPLATE("a weight laid on a sleeper wakes it; a feather does not, and sleeps with it", Real,
                       float, double) {
        for (const double mass : {1.0, 0.001}) {
            CAPTURE(mass);
            Scene scene = box(2);
            scene.add(disc(1, 1, {1, 1}));
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 60; ++i) world.step(kStep);
            REQUIRE(world.is_asleep({0, 0}));
            const BodyId second = world.add(disc(0.9, mass, {1, 3}));
            bool has_woken = false;
            for (int i = 0; i < 120; ++i) {
                world.step(kStep);
                has_woken = has_woken || !world.is_asleep({0, 0});
            }
            CHECK(has_woken == (mass == 1.0));
            CHECK(world.is_asleep({0, 0}));
            CHECK(world.is_asleep(second));
            CHECK(world.profile().islands_asleep == 1);
            world.remove({0, 0});
            CHECK_FALSE(world.is_asleep(second));
        }
    }

    TEST_CASE_TEMPLATE("the ledger closes over sleep and waking, and says what sleep took", Real, float,
                       double) {
        Scene scene = pile();
        scene.effects.ledger = true;
        BasicWorld<Real> world(scene);
        REQUIRE(sleep_all(world) < 3000);
        check_books_close(world, dynamic_mass(scene));
        const double taken = world.ledger().energy_by_cause.sleep;
        report("sleep took ", taken, " J");
        CHECK(taken < 0);
        CHECK(taken > -0.1);
        world.set_velocity(highest(world), {1, 2});
        for (int i = 0; i < 300; ++i) world.step(kStep);
        check_books_close(world, dynamic_mass(scene));
    }

    // Each that fell asleep made the pairs of all be found anew, which takes as long as some nine steps.
    TEST_CASE_TEMPLATE("discs that come to rest one after the other fall asleep by groups", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = Walls{.min = {0, 0}, .max = {200, 1000}, .material = {.friction = 0.5}};
        constexpr int kDiscs = 40;
        for (int i = 0; i < kDiscs; ++i) {  // each lands an eighth of a second after the one before
            const double time = 0.125 * (1 + i);
            scene.add(rough_disc(0.5, {2.0 + 4 * i, 0.5 + 5 * time * time}));
        }
        scene.effects.sleep = true;
        BasicWorld<Real> world(scene);
        int steps = 0, times = 0;
        for (std::int64_t asleep = 0; asleep < kDiscs && steps < 500; ++steps) {
            world.step(kStep);
            if (world.profile().asleep > asleep) ++times;
            asleep = world.profile().asleep;
        }
        report("asleep after ", steps, " steps, in ", times, " of them");
        CHECK(steps < 500);
        CHECK(times <= kDiscs / 2);
    }

    TEST_CASE_TEMPLATE("B24: a thousand bodies come and go in every step while part of a pile sleeps", Real,
                       float, double) {
        Scene scene = box(110);
        add_heap(scene, 0, 11, 60, 7);
        for (Body& body : scene.bodies) body.material.rolling_resistance = 0.05;  // or some roll for ever
        BasicWorld<Real> world(scene);
        REQUIRE(sleep_all(world) < 3000);
        std::mt19937 random(11);
        std::vector<BodyId> guests;
        const int steps = scaled(60, 6);
        for (int step = 0; step < steps; ++step) {
            for (int i = 0; i < 1000; ++i) {
                const double x = 60 + static_cast<double>(i % 40) * 1.1,
                             y = 1 + 1.1 * static_cast<double>(i / 40);
                guests.push_back(
                    world.add(rough_disc(0.4, {x, y + 0.1 * static_cast<double>(random() % 5)})));
            }
            world.step(kStep);
            for (const BodyId guest : guests) {
                CHECK_NOTHROW(world.state(guest));
                world.remove(guest);
            }
            for (const BodyId guest : guests) CHECK_THROWS_AS(world.state(guest), Error);
            guests.clear();
            CHECK(world.body_count() == 60);
        }
        CHECK(world.profile().asleep == 60);
        CHECK(world.quarantined().empty());
    }

    TEST_CASE_TEMPLATE("B24: a stack whose weight is taken away, or its base, does what gravity says", Real,
                       float, double) {
        Scene scene = box(1);  // discs of radius 0.5 between two walls
        for (int i = 0; i < 8; ++i) scene.add(rough_disc(0.5, {0.5, 0.5 + i}));
        scene.add(disc(0.5, 25, {0.5, 8.5}));  // a hundred times as heavy
        BasicWorld<Real> world(scene);
        REQUIRE(sleep_all(world) < 3000);
        world.remove({8, 0});
        double jump = 0;
        for (int i = 0; i < 60; ++i) {
            world.step(kStep);
            jump = std::fmax(jump, fastest(world));
        }
        report("without the weight at most ", jump, " m/s");
        CHECK(jump < 0.1);
        REQUIRE(sleep_all(world) < 3000);
        world.remove({0, 0});
        CHECK(world.profile().asleep == 0);
        for (int i = 0; i < 10; ++i) world.step(kStep);
        for (std::uint32_t body = 1; body < 8; ++body) CHECK(world.state({body, 0}).velocity.y < -0.5);
        REQUIRE(sleep_all(world) < 3000);
        CHECK(world.state({1, 0}).position.y == doctest::Approx(0.5).epsilon(0.01));
    }

    // After one step of half a second they slept in mid-air, where they were slowest.
    TEST_CASE_TEMPLATE("what is thrown up does not fall asleep at its highest, however long steps are", Real,
                       float, double) {
        for (const double step : {0.1, 0.25, 0.5, 1.0, 4.0}) {
            Scene scene;
            scene.gravity = {0, -10};
            scene.effects.sleep = true;
            for (int i = 0; i < 20; ++i) {
                Body thrown = rough_disc(0.5, {2.0 * i, 0});
                thrown.velocity = {0, 10 * step * (1 + 0.1 * i)};  // at its highest after a step or more
                scene.add(thrown);
            }
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 10; ++i) {
                world.step(step);
                CHECK(world.profile().asleep == 0);
            }
        }
    }
}

}  // namespace test_sleeping

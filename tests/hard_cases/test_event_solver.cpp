// B18 and B26 of docs/hard-cases.md with solver `event`, overlapping starts, and what it has to refuse.
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <cmath>
#include <string>

namespace test_event_solver {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5;

Scene exact(Scene scene) {
    scene.accuracy.solver = Solver::event;
    return scene;
}

std::string refusal(const Scene& scene) {
    try {
        World64 world(exact(scene));
    } catch (const Error& error) {
        return error.what();
    }
    return "accepted";
}

/// Bodies i and j are mirror images in the x axis.
void check_mirrored(const World64& world, std::uint32_t i, std::uint32_t j) {
    const BodyState a = world.state({i, 0}), b = world.state({j, 0});
    CHECK(std::abs(a.position.x - b.position.x) < 1e-12);
    CHECK(std::abs(a.position.y + b.position.y) < 1e-12);
    CHECK(std::abs(a.velocity.x - b.velocity.x) < 1e-12);
    CHECK(std::abs(a.velocity.y + b.velocity.y) < 1e-12);
}

void check_conserved(const World64& world, double speed) {
    const Ledger ledger = world.ledger();
    const double mass = 2 * ledger.initial.kinetic / (speed * speed);
    CHECK(std::abs(ledger.momentum.x - ledger.initial_momentum.x) <= 1e-14 * mass * speed * 4);
    CHECK(std::abs(ledger.momentum.y - ledger.initial_momentum.y) <= 1e-14 * mass * speed * 4);
    CHECK(std::abs(ledger.energy.total() / ledger.initial.total() - 1) < 1e-12);
}

}  // namespace

TEST_SUITE("hard cases/event solver") {
    TEST_CASE("B18: a ball hits two at once, and the three leave as mirror images") {
        Scene scene;
        scene.add(disc(kRadius, 1, {-2, 0}, {3, 0}, 1));
        scene.add(disc(kRadius, 1, {0, kRadius * 1.1}, {}, 1));
        scene.add(disc(kRadius, 1, {0, -kRadius * 1.1}, {}, 1));
        World64 world(exact(scene));
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.profile().simultaneous_impacts == 2);
        CHECK(world.profile().impacts == 2);
        check_mirrored(world, 1, 2);
        CHECK(std::abs(world.state({0, 0}).velocity.y) < 1e-14);
        check_conserved(world, 3);
    }

    TEST_CASE("B18: a break of fifteen balls that touch keeps its mirror symmetry") {
        Scene scene;
        scene.add(disc(kRadius, 1, {-3, 0}, {5, 0}, 1));
        for (int row = 0; row < 5; ++row)
            for (int i = 0; i <= row; ++i)
                scene.add(
                    disc(kRadius, 1, {row * std::sqrt(3.0) * kRadius, (i - 0.5 * row) * 2 * kRadius}, {}, 1));
        World64 world(exact(scene));
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.profile().impacts > 10);
        std::uint32_t first = 1;
        for (std::uint32_t row = 0; row < 5; first += ++row)
            for (std::uint32_t i = 0; i <= row; ++i) check_mirrored(world, first + i, first + row - i);
        check_conserved(world, 5);
    }

    TEST_CASE("B18: into a corner and out again, two walls at one instant") {
        Scene scene;
        scene.walls = Walls{.min = {0, 0}, .max = {10, 10}, .material = bouncy(1)};
        scene.add(disc(kRadius, 1, {3, 3}, {-2, -2}, 1));
        World64 world(exact(scene));
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.profile().wall_impacts == 2);
        const BodyState state = world.state({0, 0});
        CHECK(state.velocity.x == doctest::Approx(2).epsilon(1e-14));
        CHECK(state.position.x == doctest::Approx(2).epsilon(1e-13));  // 2.5 m in, 1.5 m out
        CHECK(state.position.x == state.position.y);
    }

    TEST_CASE("B26: three discs that would collapse do not stop time, nor do they gain energy") {
        for (const double e : {0.0, 0.02, 0.07}) {  // below 7 - 4 √3 = .0718 they collapse
            CAPTURE(e);
            Scene scene;
            scene.add(disc(kRadius, 1, {-2, 0}, {1, 0}, e));
            scene.add(disc(kRadius, 1, {0, 0}, {}, e));
            scene.add(disc(kRadius, 1, {2, 0}, {-1, 0}, e));
            World64 world(exact(scene));
            for (int i = 0; i < 600; ++i) world.step(kStep);
            CHECK(world.time() == doctest::Approx(10));
            CHECK(world.profile().impacts < 1000);
            CHECK(world.ledger().energy.total() < world.ledger().initial.total() * (e * e + 1e-6));
            CHECK(world.overlaps().max < 1e-9);
        }
    }

    TEST_CASE("B26: many discs at restitution 0.5 cluster, and time still advances at a bounded rate") {
        World64 world(exact(gas_scene({.count = 1000, .packing_fraction = 0.5, .restitution = 0.5})),
                      {.threads = 1});
        for (int i = 0; i < 120; ++i) {
            const std::int64_t before = world.profile().impacts;
            world.step(0.1);
            REQUIRE(world.profile().impacts - before < 1000000);
        }
        report(world.profile().impacts, " impacts in 12 s");
        CHECK(world.profile().impacts > 10000);
        CHECK(world.ledger().energy.total() < 0.01 * world.ledger().initial.total());
        CHECK(world.overlaps().max < 1e-9);
    }

    TEST_CASE(
        "a ball that bounces to rest shivers by less than 1e-6 of its radius, a bounded number of times") {
        Scene scene;
        scene.gravity = {0, -9.81};
        scene.walls = floor_at(0, 0.8);
        scene.add(disc(0.1, 1, {0, 1.1}, {}, 0.8));
        World64 world(exact(scene));
        for (int i = 0; i < 300; ++i) world.step(kStep);  // at rest after 4.064 s
        CHECK(std::abs(world.state({0, 0}).position.y - 0.1) < 1e-7);
        CHECK(world.profile().impacts < 300000);
        scene.bodies[0].position.y = 0.1;  // and one that lies there from the start
        World64 lying(exact(scene));
        lying.step(0.1);
        CHECK(std::abs(lying.state({0, 0}).position.y - 0.1) < 1e-7);
    }

    TEST_CASE("overlapping starts are refused, the pair named; so is what it cannot do, and who can") {
        Scene scene = gas_scene({.count = 100});
        const Vec2 x = scene.bodies[40].position;
        Scene overlapping = scene;
        overlapping.bodies[70].position = {x.x + 0.9, x.y};
        CHECK(refusal(overlapping).find("body 40 and body 70 overlap by 0.1") != std::string::npos);
        CHECK(refusal(overlapping).find("\"impulse\"") != std::string::npos);
        Scene in_wall = scene;
        in_wall.bodies.resize(1);
        in_wall.bodies[0].position = {in_wall.walls->min.x + 0.4, 0};
        CHECK(refusal(in_wall).find("body 0 and a wall overlap") != std::string::npos);
        Scene dragged = scene;
        dragged.drag.linear = 0.5;
        CHECK(refusal(dragged).find("Use \"auto\" or \"impulse\"") != std::string::npos);
        Scene resting = scene;
        resting.gravity = {0, -10};
        resting.bodies[3].material.restitution = 0, resting.walls->material.restitution = 0;
        CHECK(refusal(resting).find("body 3") != std::string::npos);
        CHECK(refusal(scene) == "accepted");
    }

    TEST_CASE("bodies may be added, moved and removed between steps") {
        World64 world(exact(gas_scene({.count = 100, .packing_fraction = 0.1})));
        world.step(0.1);
        const Vec2 x = world.state({7, 0}).position;
        CHECK_THROWS_AS(world.add(disc(0.5, 1, {x.x + 0.3, x.y}, {}, 1)), Error);
        CHECK(world.body_count() == 100);
        world.remove({7, 0});
        const BodyId added = world.add(disc(0.5, 1, x, {}, 1));
        CHECK_THROWS_AS(world.set_position(added, world.state({8, 0}).position), Error);
        CHECK(world.state(added).position.x == x.x);
        world.set_velocity(added, {1, 2});
        for (int i = 0; i < 100; ++i) world.step(0.1);
        CHECK(world.body_count() == 100);
        CHECK(world.overlaps().max < 1e-9);
    }
}

}  // namespace test_event_solver

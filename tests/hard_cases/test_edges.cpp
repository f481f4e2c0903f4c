// B9 of docs/hard-cases.md, for discs and edges: discs of 1 cm at 1000 m/s, 1,600 radii a step.
#include "support/effort.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace test_edges {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;

Vec2 turned_back(Vec2 p, const BodyState& frame) {
    const double x = p.x - frame.position.x, y = p.y - frame.position.y;
    const double c = std::cos(frame.angle), s = std::sin(frame.angle);
    return {c * x + s * y, c * y - s * x};
}

struct Shot {
    Scene scene;
    int steps;
};

/// A disc that flies at a random place of a segment 1 m long, from 5 cm to 30 m away.
Shot random_shot(std::mt19937& random, bool moves, double restitution) {
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    for (;;) {
        Body line{.type = moves ? BodyType::kinematic_body : BodyType::static_body,
                  .shape = Segment{{-0.5, 0}, {0.5, 0}},
                  .angle = uniform(0, 6.28)};
        if (moves) {
            line.velocity = {uniform(-10, 10), uniform(-10, 10)};
            line.angular_velocity = uniform(-100, 100);
        }
        const double direction = uniform(0, 2 * std::numbers::pi), aim = uniform(-0.45, 0.45);
        const double distance = moves ? uniform(0.55, 8.5) : uniform(0.05, 30), time = distance / 1000;
        const double angle = line.angle + line.angular_velocity * time;
        const Vec2 way{std::cos(direction), std::sin(direction)}, along{std::cos(angle), std::sin(angle)};
        const double steepness = std::abs(way.x * along.y - way.y * along.x);
        if (steepness < 0.05 || distance * steepness < 0.02) continue;  // at the edge, not along it
        const Vec2 target{aim * along.x + line.velocity.x * time, aim * along.y + line.velocity.y * time};
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        line.material.restitution = restitution;
        scene.add(line);
        scene.add({.shape = Disc{0.01},
                   .position = {target.x - distance * way.x, target.y - distance * way.y},
                   .velocity = {1000 * way.x, 1000 * way.y},
                   .material = {.restitution = restitution}});
        return {scene, static_cast<int>(time / kStep) + 2};
    }
}

/// Whether the disc gets from one side of the segment to the other, seen from the segment.
bool passes(const Shot& shot) {
    World world(shot.scene, {.threads = 1});
    Vec2 before = turned_back(world.state({1, 0}).position, world.state({0, 0}));
    for (int i = 0; i < shot.steps; ++i) {
        world.step(kStep);
        const Vec2 now = turned_back(world.state({1, 0}).position, world.state({0, 0}));
        if (before.y * now.y < 0) {
            const double share = before.y / (before.y - now.y);
            if (std::abs(before.x + share * (now.x - before.x)) < 0.499) return true;
        }
        before = now;
    }
    return false;
}

}  // namespace

TEST_SUITE("hard cases/edges") {
    TEST_CASE("B9: none of 10,000 shots passes a segment, one that stands or one that moves and turns") {
        for (const bool moves : {false, true})
            for (const double restitution : {0.0, 0.5}) {
                CAPTURE(moves);
                CAPTURE(restitution);
                std::mt19937 random(9);
                int passed = 0;
                for (int i = 0; i < test::scaled(10'000, 1'000); ++i)
                    passed += passes(random_shot(random, moves, restitution)) ? 1 : 0;
                CHECK(passed == 0);
            }
    }

    TEST_CASE_TEMPLATE("B9: discs at 1000 m/s do not leave a closed triangle that turns", Real, float,
                       double) {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> angle(0, 2 * std::numbers::pi), place(-0.3, 0.3);
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -10};
        Body box{.type = BodyType::kinematic_body,
                 .shape = Chain{.points = {{-2, -1}, {2, -1}, {0, 2}}, .loop = true},
                 .angular_velocity = 1};
        box.material = {.friction = 0.3, .restitution = 0.9};
        scene.add(box);
        for (int i = 0; i < 100; ++i) {
            const double direction = angle(random);
            scene.add({.shape = Disc{0.01},
                       .position = {place(random), place(random)},
                       .velocity = {1000 * std::cos(direction), 1000 * std::sin(direction)},
                       .material = {.friction = 0.3, .restitution = 0.9}});
        }
        BasicWorld<Real> world(scene);
        for (int i = 0; i < test::scaled(300, 60); ++i) world.step(kStep);
        CHECK(world.quarantined().empty());
        for (std::uint32_t i = 1; i <= 100; ++i) {
            const Vec2 p = turned_back(world.state({i, 0}).position, world.state({0, 0}));
            CAPTURE(i);
            CHECK(p.y > -1);
            CHECK(3 * p.x + 2 * p.y < 4);
            CHECK(-3 * p.x + 2 * p.y < 4);
        }
    }

    // The second edge was met at the end of a way that the first one cut short, where it is the corner that
    // is met: the ball left the first one with its speed and had none along the other.
    TEST_CASE_TEMPLATE("a ball bounces off both edges of a corner within a step", Real, float, double) {
        std::mt19937 random(5);
        std::uniform_real_distribution<double> uniform(0, 1);
        for (const double speed : {5.0, 20.0, 40.0})
            for (const double radius : {0.05, 0.15})
                for (int shot = 0; shot < test::scaled(200, 60); ++shot) {
                    const double angle = 0.1 + 1.37 * uniform(random);
                    const Vec2 v{-speed * std::cos(angle), -speed * std::sin(angle)};
                    const double way = 0.7 * speed * kStep;  // m, within which both are met in the third step
                    const Vec2 start{radius + way * uniform(random) * std::cos(angle) - 2 * kStep * v.x,
                                     radius + way * uniform(random) * std::sin(angle) - 2 * kStep * v.y};
                    Scene scene;
                    const Material elastic{.restitution = 1};
                    scene.add({.type = BodyType::static_body,
                               .shape = Chain{.points = {{8, 0}, {0, 0}, {0, 8}}},
                               .material = elastic});
                    const BodyId ball = scene.add(
                        {.shape = Disc{radius}, .position = start, .velocity = v, .material = elastic});
                    BasicWorld<Real> world(scene, {.threads = 1});
                    for (int i = 0; i < 8; ++i) world.step(kStep);
                    INFO("from ", start.x, ", ", start.y);
                    CHECK(world.state(ball).velocity.x == doctest::Approx(-v.x).epsilon(1e-4));
                    CHECK(world.state(ball).velocity.y == doctest::Approx(-v.y).epsilon(1e-4));
                }
    }
}

}  // namespace test_edges

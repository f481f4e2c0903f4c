// Segments and chains under solver `soft`: A10 of docs/exact-cases.md on a line that is tilted itself, B29 of
// docs/hard-cases.md, conveyors, joints of chains.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_edges {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kGravity = 9.81, kRadius = 0.5, kStep = 1.0 / 60;

Body rough_disc(Vec2 position, double friction, Vec2 velocity = {}) {
    Body body = disc(kRadius, 2, position, velocity);
    body.material.friction = friction;
    return body;
}

Body line(Shape shape, double friction, BodyType type = BodyType::static_body) {
    return {.type = type, .shape = std::move(shape), .material = {.friction = friction}};
}

/// A disc at rest on a line that falls to the right by `slope`.
Scene disc_on_line(double slope, double friction) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.add(line(Segment{{-5, 0}, {200, 0}}, friction));
    scene.bodies[0].angle = -slope;
    scene.add(rough_disc({kRadius * std::sin(slope), kRadius * std::cos(slope)}, friction));
    return scene;
}

Chain level_chain(double from, double to, double spacing) {
    Chain chain;
    for (double x = from; x <= to; x += spacing) chain.points.push_back({x, 0});
    return chain;
}

Chain drum_of(double radius, int sides) {
    Chain chain{.points = {}, .loop = true};
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        chain.points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
    }
    return chain;
}

/// Discs in a drum of radius 6 m that turns with 0.5 rad/s.
Scene drum_scene() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.add(line(drum_of(6, 48), 0.5, BodyType::kinematic_body));
    scene.bodies[0].angular_velocity = 0.5;
    for (int i = 0; i < 48; ++i)
        scene.add({.shape = Disc{0.3 + 0.05 * (i % 3)},
                   .position = {-3.2 + 0.9 * (i % 8), -3 + 0.9 * (i / 8)},
                   .material = {.friction = 0.5}});
    return scene;
}

struct Turning {
    double momentum = 0;  // angular, of the discs about the origin
    double moment = 0;    // of their weight
};

template <class Real>
Turning turning_of(const BasicWorld<Real>& world, const Scene& scene) {
    Turning sum;
    for (std::uint32_t i = 1; i < scene.bodies.size(); ++i) {
        const double radius = std::get<Disc>(scene.bodies[i].shape).radius;
        const double mass = std::numbers::pi * radius * radius;
        const BodyState s = world.state({i, 0});
        sum.momentum += mass * (s.position.x * s.velocity.y - s.position.y * s.velocity.x) +
                        0.5 * mass * radius * radius * s.angular_velocity;
        sum.moment += mass * scene.gravity.y * s.position.x;
    }
    return sum;
}

}  // namespace

TEST_SUITE("physics/edges") {
    TEST_CASE_TEMPLATE("A10: a disc rolls down a tilted segment with two thirds of the acceleration", Real,
                       float, double) {
        for (const double slope : {0.1, 0.4, 0.8}) {
            CAPTURE(slope);
            Trial<Real> trial(disc_on_line(slope, 1.01 * std::tan(slope) / 3));
            trial.run(120, kStep);
            trial.check();
            const BodyState state = trial.state(1);
            const double along = state.position.x * std::cos(slope) - state.position.y * std::sin(slope);
            const double way = 0.5 * (2.0 / 3) * kGravity * std::sin(slope) * 4;
            report("slope ", slope, ": way off by ", along / way - 1);
            const double rounding = sizeof(Real) == sizeof(float) ? 1e-5 : 1e-12;
            CHECK(along == doctest::Approx(way).epsilon(rounding));
            CHECK(-state.angle == doctest::Approx(way / kRadius).epsilon(rounding));
            const double height = state.position.x * std::sin(slope) + state.position.y * std::cos(slope);
            CHECK(height == doctest::Approx(kRadius).epsilon(1e-5));
        }
    }

    TEST_CASE_TEMPLATE("A10: with less friction it slides", Real, float, double) {
        const double slope = 0.5, friction = 0.5 * std::tan(slope) / 3;
        Trial<Real> trial(disc_on_line(slope, friction));
        trial.run(60, kStep);
        trial.check();
        const BodyState state = trial.state(1);
        const double speed = std::hypot(state.velocity.x, state.velocity.y);
        CHECK(speed ==
              doctest::Approx(kGravity * (std::sin(slope) - friction * std::cos(slope))).epsilon(1e-5));
        CHECK(-state.angular_velocity ==
              doctest::Approx(2 * friction * kGravity * std::cos(slope) / kRadius).epsilon(1e-5));
    }

    TEST_CASE_TEMPLATE("A10: boxes, capsules and polygons slide down a straight chain as on a plane", Real,
                       float, double) {
        // Whether joints of a tilted line are bent is a matter of round-off.
        const Polygon triangle{{{-0.5, -0.2}, {0.5, -0.2}, {0, 0.4}}};
        const struct {
            Shape shape;
            double below;  // m, from the centre to what lies on the chain
        } shapes[] = {{Box{1, 0.6}, 0.3}, {Capsule{0.5, 0.3}, 0.3}, {triangle, 0.2}};
        for (const double slope : {0.12, 0.6, 0.9})  // height over way
            for (const double spacing : {0.3, 1.0, 1.7}) {
                CAPTURE(slope);
                CAPTURE(spacing);
                const double angle = std::atan(slope), friction = 0.5 * slope;
                Chain chain;
                for (double x = -2; x < 40; x += spacing) chain.points.push_back({x, -slope * x});
                Scene scene;
                scene.gravity = {0, -kGravity};
                scene.add(line(chain, friction));
                for (int i = 0; i < 12; ++i) {
                    const auto& [shape, below] = shapes[i % 3];
                    const double along = 0.37 * i;  // m
                    Body body{.shape = shape, .angle = -angle, .material = {.friction = friction}};
                    body.group = -1;
                    body.position = {along * std::cos(angle) + below * std::sin(angle),
                                     below * std::cos(angle) - along * std::sin(angle)};
                    scene.add(body);
                }
                BasicWorld<Real> world(scene);
                for (int i = 0; i < 120; ++i) world.step(kStep);
                CHECK(world.overlaps().max < 0.02);
                const double acceleration = kGravity * (std::sin(angle) - friction * std::cos(angle));
                for (std::uint32_t i = 0; i < 12; ++i) {
                    CAPTURE(i);
                    const BodyState state = world.state({i + 1, 0});
                    const double along =
                        state.position.x * std::cos(angle) - state.position.y * std::sin(angle);
                    CHECK(along - 0.37 * i == doctest::Approx(0.5 * acceleration * 4).epsilon(0.01));
                    CHECK(state.angle == doctest::Approx(-angle).epsilon(1e-3));
                }
            }
    }

    TEST_CASE_TEMPLATE("a disc that rolls over the joints of a level chain keeps its velocity", Real, float,
                       double) {
        for (const double spacing : {0.1, 1.0, 5.0})
            for (const double speed : {1.0, 5.0, 30.0}) {
                CAPTURE(spacing);
                CAPTURE(speed);
                Scene scene;
                scene.gravity = {0, -kGravity};
                scene.add(line(level_chain(-5, 60, spacing), 0.5));
                scene.add(rough_disc({0, kRadius}, 0.5, {speed, 0}));
                scene.bodies[1].angular_velocity = -speed / kRadius;
                Trial<Real> trial(scene);
                double worst = 0;
                for (int i = 0; i < static_cast<int>(scaled(50, 15) / speed * 60); ++i) {
                    trial.step(kStep);
                    const BodyState s = trial.state(1);
                    worst = std::max({worst, std::abs(s.velocity.y), std::abs(s.velocity.x - speed),
                                      std::abs(s.position.y - kRadius)});
                }
                trial.check();
                CHECK(worst <= 1e-5);
            }
    }

    TEST_CASE("a heavier pile on a chain's joints sinks no deeper than on a segment") {
        const auto deepest = [](Shape floor) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.walls = Walls{.min = {-3, -1}, .max = {3, 50}, .bottom = false, .top = false};
            scene.add(line(std::move(floor), 0.5));
            for (int i = 0; i < 60; ++i)
                scene.add(rough_disc({-2.4 + 1.1 * (i % 5) + 0.05 * (i / 5 % 2), 0.6 + 1.1 * (i / 5)}, 0.5));
            World world(scene);
            for (int i = 0; i < 600; ++i) world.step(kStep);
            return world.overlaps();
        };
        const OverlapReport whole = deepest(Segment{{-4, 0}, {4, 0}}),
                            joined = deepest(level_chain(-4, 4, 0.5));
        report("pile on a segment ", whole.max, ", on a chain ", joined.max);
        CHECK(whole.touching > 60);
        CHECK(joined.touching > 60);
        CHECK(whole.max < 0.02);
        CHECK(joined.max < 0.02);
    }

    TEST_CASE_TEMPLATE("a conveyor brings a disc to a third of its speed, one that cannot turn to all of it",
                       Real, float, double) {
        for (const bool fixed : {false, true}) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.add(line(Segment{{-100, 0}, {100, 0}}, 0.4, BodyType::kinematic_body));
            scene.bodies[0].velocity = {3, 0};
            scene.add(rough_disc({0, kRadius}, 0.4));
            scene.bodies[1].fixed_rotation = fixed;
            Trial<Real> trial(scene);
            trial.run(120, kStep);
            trial.check();
            const BodyState state = trial.state(1);
            CHECK(state.velocity.x == doctest::Approx(fixed ? 3.0 : 1.0).epsilon(1e-5));
            CHECK(state.angular_velocity ==
                  doctest::Approx(fixed ? 0.0 : (3.0 - 1.0) / kRadius).epsilon(1e-5));
            // Impulse of the friction times the speed of the belt: m v · V.
            const double drive = trial.all_on.ledger().energy_by_cause.drive;
            CHECK(drive == doctest::Approx(2 * state.velocity.x * 3).epsilon(1e-4));
        }
    }

    TEST_CASE_TEMPLATE("B29: what a drum's discs gain is the work of its torque", Real, float, double) {
        const Scene scene = drum_scene();
        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
        const Turning start = turning_of(world, scene);
        double weight = 0;  // integral of its moment
        Turning before = start;
        for (int i = 0; i < 1800; ++i) {
            world.step(kStep);
            const Turning now = turning_of(world, scene);
            weight += 0.5 * (before.moment + now.moment) * kStep;
            before = now;
        }
        // All contacts with the drum turn with it, so their power is spin times moment about its axis.
        const double work = 0.5 * (before.momentum - start.momentum - weight);
        const Ledger ledger = world.ledger();
        const EnergyByCause& cause = ledger.energy_by_cause;
        const double gained = ledger.energy.total() - ledger.initial.total();
        report("drum: work of the torque ", work, " J, drive ", cause.drive, " J, unexplained ",
               cause.unexplained, " J");
        CHECK(work > 1000);
        // The arm of an impulse about the axis is that of the start of its substep: 0.3 %.
        CHECK(cause.drive == doctest::Approx(work).epsilon(0.006));
        CHECK(gained == doctest::Approx(work + cause.friction + cause.restitution + cause.correction)
                            .epsilon(0.01 * work / std::abs(gained)));
        CHECK(std::abs(cause.unexplained) < (sizeof(Real) == sizeof(float) ? 1e-5 : 1e-11) * work);
        for (std::uint32_t i = 1; i < scene.bodies.size(); ++i) {
            const Vec2 x = world.state({i, 0}).position;
            CHECK(std::hypot(x.x, x.y) < 6);
        }
        CHECK(world.state({0, 0}).angle == doctest::Approx(15).epsilon(1e-5));
        CHECK(world.overlaps().max < 0.02);
    }

    TEST_CASE_TEMPLATE("a disc bounces off a segment with its restitution, from above and from below", Real,
                       float, double) {
        for (const double side : {1.0, -1.0}) {
            Scene scene;
            scene.accuracy.solver = Solver::soft;
            scene.add(line(Segment{{-1, 0}, {1, 0}}, 0));
            scene.bodies[0].material.restitution = 0.75;
            scene.add(disc(0.1, 1, {0.3, side * 1.0}, {0.5, side * -4}, 0.75));
            Trial<Real> trial(scene);
            trial.run(30, kStep);
            trial.check();
            CHECK(trial.state(1).velocity.y == doctest::Approx(side * 3).epsilon(1e-6));
            CHECK(trial.state(1).velocity.x == doctest::Approx(0.5).epsilon(1e-6));
        }
    }

    TEST_CASE("overlaps with edges are measured, at a joint once") {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.add(line(Chain{.points = {{-1, 0}, {0, 0}, {1, 0}}}, 0));
        scene.add(disc(0.5, 1, {0, 0.45}));
        scene.add(disc(0.5, 1, {-0.5, -0.5001}));
        const World world(scene);
        CHECK(world.overlaps().touching == 1);
        CHECK(world.overlaps().max == doctest::Approx(0.1).epsilon(1e-5));
    }

    TEST_CASE("edge bodies can be added, moved and removed while discs lie on them") {
        Scene scene;
        scene.gravity = {0, -kGravity};
        scene.add(line(Segment{{-5, 0}, {0, 0}}, 0.5));
        scene.add(rough_disc({-2, kRadius}, 0.5));
        scene.add(rough_disc({2, kRadius}, 0.5));
        World world(scene);
        const BodyId second = world.add(line(level_chain(0, 5, 1), 0.5));
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(std::abs(world.state({1, 0}).position.y - kRadius) < 1e-4);
        CHECK(std::abs(world.state({2, 0}).position.y - kRadius) < 1e-4);
        world.remove({0, 0});
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state({1, 0}).position.y == doctest::Approx(kRadius - 0.5 * kGravity).epsilon(1e-3));
        CHECK(std::abs(world.state({2, 0}).position.y - kRadius) < 1e-4);
        world.set_position(second, {0, -3});
        for (int i = 0; i < 180; ++i) world.step(kStep);
        CHECK(world.state({2, 0}).position.y == doctest::Approx(kRadius - 3).epsilon(1e-4));
        CHECK_THROWS_AS(world.state({0, 0}), Error);
    }

    TEST_CASE_TEMPLATE("discs fall freely when the world's last segment or chain is removed from under them",
                       Real, float, double) {
        const Shape shapes[] = {Segment{{-5, 0}, {5, 0}}, level_chain(-5, 5, 1)};
        for (const Shape& shape : shapes) {
            Scene scene;
            scene.gravity = {0, -kGravity};
            scene.add(line(shape, 0.5));
            for (int i = 0; i < 3; ++i) scene.add(rough_disc({1.5 * i - 1.2, kRadius}, 0.5));
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 30; ++i) world.step(kStep);
            world.remove({0, 0});
            for (int i = 0; i < 60; ++i) world.step(kStep);
            for (std::uint32_t body = 1; body <= 3; ++body)
                CHECK(world.state({body, 0}).position.y ==
                      doctest::Approx(kRadius - 0.5 * kGravity).epsilon(1e-4));
            world.add(line(shape, 0.5));  // above them
            for (int i = 0; i < 30; ++i) world.step(kStep);
            CHECK(world.state({1, 0}).velocity.y == doctest::Approx(-1.5 * kGravity).epsilon(1e-4));
        }
    }
}

}  // namespace test_edges

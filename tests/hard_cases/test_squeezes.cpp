// B37 of docs/hard-cases.md: what a kinematic body squeezes against what stands is not shot out.
#include "support/effort.hpp"
#include "support/report.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kPlateSpeed = 0.6, kTilt = 0.02;  // m/s, rad

struct Squeeze {
    int bodies;
    double friction, turning;  // turning: of the plate [rad/s]
    std::uint32_t seed;
};

/// Boxes and triangles on a floor, and a plate, hardly tilted, that comes down on them at 0.6 m/s.
Scene scene_of(const Squeeze& squeeze) {
    std::mt19937 random(squeeze.seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    const Material material{.friction = squeeze.friction};
    scene.add(
        {.type = BodyType::static_body, .shape = Box{40, 1}, .position = {0, -0.5}, .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Box{40, 1},
               .position = {0, 3},
               .angle = kTilt,
               .velocity = {0, -kPlateSpeed},
               .angular_velocity = squeeze.turning,
               .material = material});
    for (int i = 0; i < squeeze.bodies; ++i) {
        const double width = uniform(0.4, 0.8), height = uniform(0.4, 0.8);
        Shape shape = Polygon{{{-0.4, -0.3}, {0.4, -0.3}, {0, 0.5}}};
        if (i % 2 == 1) shape = Box{width, height};
        const double x = uniform(-2, 2), y = uniform(0.5, 2), angle = uniform(0, 6);
        scene.add({.shape = shape,
                   .position = {x, y},
                   .angle = angle,
                   .mass = uniform(1, 10),
                   .material = material});
    }
    return scene;
}

/// The fastest that a body is while the plate comes down for five seconds and goes up for one [m/s].
template <class Real>
double fastest(const Squeeze& squeeze) {
    const Scene scene = scene_of(squeeze);
    BasicWorld<Real> world(scene, {.threads = 1});
    double most = 0;
    for (int i = 0; i < 360; ++i) {
        if (i == 300) world.set_velocity({1, 0}, {0, kPlateSpeed});
        world.step(kStep);
        for (std::uint32_t body = 2; body < scene.bodies.size(); ++body) {
            const Vec2 v = world.state({body, 0}).velocity;
            most = std::fmax(most, std::hypot(v.x, v.y));
        }
    }
    CHECK(world.quarantined().empty());
    return most;
}

/// How often a body is outside of a closed room, on whose floor and walls a kinematic disc and box press as
/// they leave it.
template <class Real>
int times_outside() {
    constexpr int kBodies = 40;
    constexpr double kWidth = 8, kHeight = 4;  // m
    std::mt19937 random(37);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    const Material material{.friction = 0.5};
    scene.add({.type = BodyType::static_body,
               .shape = Chain{.points = {{0, 0}, {kWidth, 0}, {kWidth, kHeight}, {0, kHeight}}, .loop = true},
               .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Disc{1},
               .position = {3, 3},
               .velocity = {0, -0.5},
               .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Box{1.5, 2},
               .position = {5, 2},
               .velocity = {0.5, -0.2},
               .angular_velocity = 0.3,
               .material = material});
    for (int i = 0; i < kBodies; ++i) {
        Shape shape = Box{uniform(0.2, 0.8), 0.3};
        if (i % 3 == 1) shape = Capsule{0.4, 0.1};
        if (i % 3 == 2) shape = Polygon{{{-0.3, -0.2}, {0.3, -0.2}, {0, 0.4}}};
        const double x = uniform(0.6, kWidth - 0.6), y = uniform(0.6, kHeight - 0.6);
        scene.add({.shape = shape, .position = {x, y}, .angle = uniform(0, 6), .material = material});
    }
    BasicWorld<Real> world(scene, {.threads = 1});
    int count = 0;
    for (int i = 0; i < 900; ++i) {
        world.step(kStep);
        for (std::uint32_t body = 3; body < scene.bodies.size(); ++body) {
            const Vec2 p = world.state({body, 0}).position;
            count += p.x > 0 && p.x < kWidth && p.y > 0 && p.y < kHeight ? 0 : 1;
        }
    }
    return count;
}

}  // namespace

TEST_SUITE("hard cases/squeezes") {
    TEST_CASE_TEMPLATE("B37: shapes that a plate squeezes are not shot out", Real, float, double) {
        const double wedge = kPlateSpeed / std::tan(kTilt);  // m/s: what is smooth slides out so fast
        double most = 0;
        for (const double friction : {0.5, 5.0})
            for (const double turning : {0.0, 0.02})
                for (const int bodies : {1, 3, 10})
                    for (std::uint32_t seed = 1; seed <= static_cast<std::uint32_t>(test::scaled(6, 1));
                         ++seed) {
                        const Squeeze squeeze{bodies, friction, turning, seed};
                        CAPTURE(friction);
                        CAPTURE(turning);
                        CAPTURE(bodies);
                        CAPTURE(seed);
                        const double speed = fastest<Real>(squeeze);
                        most = std::fmax(most, speed);
                        CHECK(speed < 3 * wedge);
                    }
        test::report("fastest ", most, " m/s, of a smooth wedge ", wedge);
    }

    TEST_CASE_TEMPLATE("B37: shapes that are pressed against the walls of a closed room do not leave it",
                       Real, float, double) {
        const int outside = times_outside<Real>();
        test::report(outside, " times a body was outside");
        CHECK(outside == 0);
    }
}

// Cars whose wheels are driven: motors and grips of all wheels act on one motion.
#include "support/report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

namespace test_driven_wheels {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kRadius = 0.5;  // m, of a wheel
constexpr double kSpin = 20;     // rad/s, that motors ask for
constexpr Material kRoad{.friction = 0.9};

struct Masses {
    double body, wheel;  // kg
};

struct Car {
    BodyId body;
    std::array<BodyId, 2> wheel;
    std::array<JointId, 2> joint;
};

Car add_car(Scene& scene, Masses mass, double spin, double torque) {
    Car car;
    car.body = scene.add(
        {.shape = Box{3, 0.6}, .position = {0, 1.2}, .mass = mass.body, .material = kRoad, .group = -1});
    for (std::size_t i = 0; i < car.wheel.size(); ++i) {
        const Vec2 at{i == 0 ? -1.0 : 1.0, kRadius};
        car.wheel[i] = scene.add(
            {.shape = Disc{kRadius}, .position = at, .mass = mass.wheel, .material = kRoad, .group = -1});
        car.joint[i] = scene.add(Joint{.a = car.body,
                                       .b = car.wheel[i],
                                       .kind = WheelJoint{.anchor = at,
                                                          .axis = {0, 1},
                                                          .frequency = 4,
                                                          .damping_ratio = 0.7,
                                                          .motor_speed = -spin,
                                                          .max_motor_torque = torque}});
    }
    return car;
}

Scene road(const std::vector<Vec2>& points) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.add({.type = BodyType::static_body, .shape = Chain{points}, .material = kRoad});
    return scene;
}

}  // namespace

TEST_SUITE("hard cases: driven wheels") {
    // Wheels differed by up to 1.14 m/s (dt 1/30 s: 2.3), their joints were open by 13 mm (52): motors held
    // in the answers to contacts whatever torque that took, and had it taken from them by the next turn.
    TEST_CASE_TEMPLATE("a car with two driven wheels cruises as one", Real, float, double) {
        struct Drive {
            Masses mass;
            double torque;  // N m, of each wheel at most
        };
        for (const double dt : {1.0 / 30, 1.0 / 60, 1.0 / 120})
            for (const Drive& drive : {Drive{{30, 1}, 30}, {{30, 1}, 20}, {{10, 0.5}, 10}, {{30, 3}, 30}}) {
                CAPTURE(dt);
                CAPTURE(drive.torque);
                Scene scene = road({{-20, 0}, {2000, 0}});
                const Car car = add_car(scene, drive.mass, kSpin, drive.torque);
                BasicWorld<Real> world(scene);
                const auto along = [&](BodyId body) { return world.state(body).velocity.x; };
                const auto steps = [dt](double seconds) {
                    return static_cast<int>(std::lround(seconds / dt));
                };
                double gap = 0, apart = 0, change = 0, torque = 0;  // m, m/s, m/s a step, N m
                for (int i = 1; i <= steps(10); ++i) {
                    const double before = along(car.wheel[0]);
                    world.step(dt);
                    gap = std::fmax(gap, world.joint_errors().max);
                    for (const JointId joint : car.joint)
                        torque = std::fmax(torque, std::fabs(world.joint_torque(joint)));
                    if (i == steps(1)) {
                        // Ground that does not slip pushes with T / r a wheel, and a wheel that rolls counts
                        // as one and a half of its mass. What touches has the velocity of half a substep ago.
                        const double of_wheel = 1.5 * drive.mass.wheel, mass = drive.mass.body + 2 * of_wheel,
                                     speed = (drive.mass.body * along(car.body) +
                                              of_wheel * (along(car.wheel[0]) + along(car.wheel[1]))) /
                                             mass,
                                     exact = 2 * drive.torque / kRadius / mass * (1 - dt / 8);
                        CHECK(std::fabs(speed - exact) < 1e-4 * exact);
                    }
                    if (i <= steps(5)) continue;
                    apart = std::fmax(apart, std::fabs(along(car.wheel[0]) - along(car.wheel[1])));
                    change = std::fmax(change, std::fabs(along(car.wheel[0]) - before));
                }
                report("car of ", drive.mass.body, " kg, wheels of ", drive.mass.wheel, " kg, ", drive.torque,
                       " N m, dt ", dt, ": wheels differ by ", apart, " m/s, change by ", change,
                       " m/s a step, joints open by ", gap, " m, speed ", along(car.body), " m/s, torque ",
                       torque, " N m");
                CHECK(apart < 0.02);
                CHECK(change < 0.02);
                CHECK(gap < 1e-4);
                CHECK(torque < (1 + 1e-6) * drive.torque);
                CHECK(std::fabs(along(car.body) - kSpin * kRadius) < 0.01);
            }
    }

    // Joints were open by 26 mm, and by 93 with wheels of 1 kg.
    TEST_CASE_TEMPLATE("driven wheels stay on their axes over hills", Real, float, double) {
        struct Ride {
            double wheel, torque;  // kg, N m
        };
        std::vector<Vec2> points;
        for (double x = -10; x < 200; x += 0.5)
            points.push_back({x, x < 5 ? 0 : 1.2 * std::sin(0.5 * (x - 5)) * std::fmin(1, (x - 5) / 20)});
        for (const Ride& ride : {Ride{1, 60}, {3, 60}, {3, 200}}) {
            Scene scene = road(points);
            const Car car = add_car(scene, {30, ride.wheel}, 10, ride.torque);
            BasicWorld<Real> world(scene);
            double gap = 0;
            for (int i = 0; i < 720; ++i) {
                world.step(1.0 / 60);
                gap = std::fmax(gap, world.joint_errors().max);
            }
            report("hills, wheels of ", ride.wheel, " kg, ", ride.torque, " N m: joints open by ", gap,
                   " m, way ", world.state(car.body).position.x, " m");
            CHECK(gap < 1e-3);
            CHECK(world.state(car.body).position.x > 40);
        }
    }

    TEST_CASE_TEMPLATE("a lift that is too weak sinks as its load has it", Real, float, double) {
        constexpr double kLoad = 300, kPlate = 1, kForce = 2000, kGravity = 10;  // kg, kg, N, m/s²
        Scene scene;
        scene.gravity = {0, -kGravity};
        const BodyId plate = scene.add({.shape = Box{2, 0.3}, .mass = kPlate, .material = kRoad});
        scene.add({.shape = Box{1, 1}, .position = {0, 0.65}, .mass = kLoad, .material = kRoad});
        scene.add(Joint{.b = plate,
                        .kind = PrismaticJoint{.axis = {0, 1}, .motor_speed = 1, .max_motor_force = kForce}});
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
        const double exact = kForce / (kLoad + kPlate) - kGravity;
        report("weak lift: ", world.state(plate).velocity.y, " m/s after 1 s, exact ", exact);
        // Velocities may be those of half a substep before or after.
        CHECK(std::fabs(world.state(plate).velocity.y - exact) < 3e-3 * std::fabs(exact));
    }
}

}  // namespace test_driven_wheels

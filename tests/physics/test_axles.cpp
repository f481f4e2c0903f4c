// Wheels and sliders of crowds, which are swept: springs, motors, ends and turning axes against exact
// physics. docs/decisions/0097-crowds-that-hang.md.
#include "math/vec2_math.hpp"
#include "support/report.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

namespace test_axles {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kPi = 3.14159265358979323846;

/// Two mechanisms, as many as a crowd needs, that fall freely far from each other.
/// @param add  adds one of them, in the origin  @return the scene, which is known to be swept
template <class Add>
Scene two_of(const Add& add) {
    Scene scene;
    scene.gravity = {0, -10};
    for (const double x : {0.0, 100.0}) add(scene, Vec2{x, 0});
    REQUIRE(World(scene).plan().joints.find("swept") != std::string::npos);
    REQUIRE(World(scene).plan().joints.find("beside") == std::string::npos);
    return scene;
}

/// A chassis of 12 kg (box of 3 m by 1 m) on two wheels of 2 kg at its ends, which move down at 1 m/s against
/// it, all at rest as a whole.
struct Suspension {
    double frequency, ratio;  // Hz, no unit
    static constexpr double kChassis = 12, kWheel = 2, kSide = 1.2;

    void operator()(Scene& scene, Vec2 at) const {
        const double down = 1 / (1 + 2 * kWheel / kChassis);  // m/s, of the wheels
        const BodyId chassis =
            scene.add({.shape = Box{3, 1}, .position = at, .velocity = {0, 1 - down}, .mass = kChassis});
        for (const double side : {-kSide, kSide}) {
            const Vec2 place = at + Vec2{side, -1};
            const BodyId wheel =
                scene.add({.shape = Disc{0.4}, .position = place, .velocity = {0, -down}, .mass = kWheel});
            scene.add(Joint{.a = chassis,
                            .b = wheel,
                            .kind = WheelJoint{.frequency = frequency, .damping_ratio = ratio}});
        }
    }
    /// The squared frequency of the swing over that of one spring alone, no unit. A spring is as stiff as (2
    /// π f)² times the mass that it moves, chassis and wheel at its lever; both together act on the wheels as
    /// one body and on the chassis.
    double over_alone() const {
        const double inertia = kChassis * (3 * 3 + 1 * 1) / 12.0;
        return (2 / kChassis + 1 / kWheel) / (1 / kChassis + 1 / kWheel + kSide * kSide / inertia);
    }
    /// How far the wheels are below where they rest, at a time [m].
    double exact(double time) const {
        const double squared = over_alone(), w = 2 * kPi * frequency * std::sqrt(squared),
                     decay = ratio * 2 * kPi * frequency * squared,  // 1/s, c / 2m
            damped = std::sqrt(w * w - decay * decay);
        return std::exp(-decay * time) * std::sin(damped * time) / damped;
    }
};

/// A rod of 2 kg (2 m by .1 m) that spins, with two beads of 1 kg that slide out on it.
struct SpinningRod {
    static constexpr double kRod = 2, kBead = 1, kStart = 0.3, kSpin = 3;  // kg, kg, m, rad/s

    void operator()(Scene& scene, Vec2 at) const {
        const BodyId rod =
            scene.add({.shape = Box{2, 0.1}, .position = at, .angular_velocity = kSpin, .mass = kRod});
        for (const double side : {-kStart, kStart}) {
            const BodyId bead = scene.add({.shape = Box{0.1, 0.1},
                                           .position = at + Vec2{side, 0},
                                           .velocity = {0, kSpin * side},
                                           .angular_velocity = kSpin,
                                           .mass = kBead});
            scene.add(Joint{.a = rod, .b = bead, .kind = PrismaticJoint{}});
        }
    }
    static double inertia(double way) {
        return kRod * (2 * 2 + 0.1 * 0.1) / 12 + 2 * kBead * (2 * 0.1 * 0.1 / 12 + way * way);
    }
    /// How far out the beads are at a time [m]: their energy is 2 × 1/2 m r'^2 + L² / 2 I(r), so that
    /// r'' = spin² r, in small steps by the midpoint.
    static double exact(double time) {
        const double momentum = inertia(kStart) * kSpin;
        double way = kStart, speed = 0;
        constexpr int kSteps = 20000;
        const double h = time / kSteps;
        const auto pull = [&](double r) { return std::pow(momentum / inertia(r), 2) * r; };
        for (int i = 0; i < kSteps; ++i) {
            const double half_way = way + h / 2 * speed, half_speed = speed + h / 2 * pull(way);
            way += h * half_speed, speed += h * pull(half_way);
        }
        return way;
    }
};

/// A slider of 1 kg on a body of 3 kg, with a motor and ends, and a second one without.
struct DrivenSlider {
    PrismaticJoint joint;

    void operator()(Scene& scene, Vec2 at) const {
        const BodyId base = scene.add({.shape = Box{2, 0.5}, .position = at, .angle = 0.5, .mass = 3});
        const Vec2 axis{std::cos(0.5), std::sin(0.5)};
        for (const double side : {0.8, -0.8}) {
            const BodyId slider =
                scene.add({.shape = Box{0.4, 0.4}, .position = at + side * Vec2{-axis.y, axis.x}, .mass = 1});
            PrismaticJoint own = joint;
            own.axis = axis;
            scene.add(Joint{.a = base, .b = slider, .kind = own});
        }
    }
};

/// The way of the first slider along the axis of its base [m], and across it from where it was.
Vec2 way_of(const World64& world) {
    const BodyState base = world.state({0, 0}), slider = world.state({1, 0});
    const Vec2 axis{std::cos(base.angle), std::sin(base.angle)};
    const Vec2 between{slider.position.x - base.position.x, slider.position.y - base.position.y};
    return {between.x * axis.x + between.y * axis.y, between.y * axis.x - between.x * axis.y};
}

}  // namespace

TEST_SUITE("wheels and sliders of crowds") {
    TEST_CASE("suspensions swing and damp as their springs say, whatever the step") {
        for (const double frequency : {1.0, 4.0})
            for (const double ratio : {0.0, 0.2})
                for (const double dt : {1.0 / 60, 1.0 / 120}) {
                    const Suspension one{frequency, ratio};
                    World64 world(two_of(one));
                    double worst = 0, across = 0, time = 0;
                    const double amplitude = 1 / (2 * kPi * frequency * std::sqrt(one.over_alone()));
                    for (time = dt; time < 2; time += dt) {
                        world.step(dt);
                        const BodyState chassis = world.state({0, 0}), wheel = world.state({1, 0});
                        const double below = chassis.position.y - wheel.position.y - 1;
                        worst = std::max(worst, std::fabs(below - one.exact(time)));
                        across = std::max(
                            across, std::fabs(wheel.position.x - chassis.position.x + Suspension::kSide));
                    }
                    report("suspensions of ", frequency, " Hz, damping ", ratio, ", steps of ", dt,
                           " s: off the exact way by ", worst / amplitude, " of the amplitude");
                    CHECK(worst < 0.05 * amplitude);
                    CHECK(across < 1e-6);
                }
    }

    TEST_CASE("beads on a rod that spins go out as they do, and keep energy and momentum") {
        constexpr double kTime = 1;
        for (const double dt : {1.0 / 60, 1.0 / 240}) {
            World64 world(two_of(SpinningRod{}));
            double across = 0;
            int steps = 0;
            for (; steps * dt < kTime - dt / 2; ++steps) {
                world.step(dt);
                across = std::max(across, world.joint_errors().max);
            }
            const BodyState rod = world.state({0, 0}), left = world.state({1, 0}),
                            right = world.state({2, 0});
            const double way = 0.5 * std::sqrt(length_squared(right.position - left.position));
            const double exact = SpinningRod::exact(kTime), spin = rod.angular_velocity,
                         momentum = SpinningRod::inertia(exact) * spin,
                         at_start = SpinningRod::inertia(SpinningRod::kStart) * SpinningRod::kSpin;
            // The energies [J] are those of motion against the centre: beads go out and round.
            const double apart = 0.5 * std::sqrt(length_squared(right.velocity - left.velocity)),
                         energy = SpinningRod::kBead * apart * apart +
                                  0.5 *
                                      (SpinningRod::inertia(exact) - 2 * SpinningRod::kBead * exact * exact) *
                                      spin * spin,
                         energy_at_start = 0.5 * at_start * SpinningRod::kSpin;
            report("beads, steps of ", dt, " s: way ", way, " m (", exact, "), angular momentum ",
                   momentum / at_start, ", energy ", energy / energy_at_start, " of the start's, across by ",
                   across, " m");
            CHECK(energy == doctest::Approx(energy_at_start).epsilon(dt));
            CHECK(exact > 2 * SpinningRod::kStart);
            CHECK(way == doctest::Approx(exact).epsilon(dt));
            CHECK(momentum == doctest::Approx(at_start).epsilon(dt));
            CHECK(across < 1e-3);
        }
    }

    TEST_CASE("sliders go as fast as their motors say, as far as their ends, and no farther turned") {
        World64 world(
            two_of(DrivenSlider{{.lower = -1, .upper = 0.5, .motor_speed = 1, .max_motor_force = 50}}));
        const double across = way_of(world).y;
        for (int i = 0; i < 24; ++i) world.step(1.0 / 60);
        CHECK(way_of(world).x == doctest::Approx(0.4).epsilon(0.02));
        for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
        CHECK(way_of(world).x == doctest::Approx(0.5).epsilon(1e-3));
        CHECK(way_of(world).y == doctest::Approx(across).epsilon(1e-4));
        CHECK(world.state({1, 0}).angle == doctest::Approx(world.state({0, 0}).angle - 0.5).epsilon(1e-4));
        CHECK(world.joint_errors().max < 1e-4);
    }

    TEST_CASE("a motor that is too weak for a slider gives all its force") {
        World64 world(two_of(DrivenSlider{{.motor_speed = 100, .max_motor_force = 3}}));
        for (int i = 0; i < 60; ++i) world.step(1.0 / 60);
        // Two sliders of 1 kg, each with 3 N, against a base of 3 kg that gets 6 N: 3 + 2 m/s².
        CHECK(way_of(world).x == doctest::Approx(0.5 * (3 + 2)).epsilon(0.02));
    }

    TEST_CASE("wheels whose axis is held are hinges with a motor") {
        World64 world(two_of([](Scene& scene, Vec2 at) {
            const BodyId chassis = scene.add({.shape = Box{3, 1}, .position = at, .mass = 12});
            for (const double side : {-1.2, 1.2}) {
                const BodyId wheel =
                    scene.add({.shape = Disc{0.4}, .position = at + Vec2{side, -1}, .mass = 2});
                scene.add(Joint{.a = chassis,
                                .b = wheel,
                                .kind = WheelJoint{.motor_speed = -6 * side, .max_motor_torque = 0.2}});
            }
        }));
        for (int i = 0; i < 30; ++i) world.step(1.0 / 60);
        const double torque = 0.2, inertia = 2 * 0.4 * 0.4 / 2;  // opposite on both: the chassis stays
        CHECK(world.state({1, 0}).angular_velocity == doctest::Approx(0.5 * torque / inertia).epsilon(1e-3));
        CHECK(world.state({2, 0}).angular_velocity == doctest::Approx(-0.5 * torque / inertia).epsilon(1e-3));
        CHECK(world.joint_errors().max < 1e-5);
        CHECK(world.joint_torque(JointId::of(0, 0)) == doctest::Approx(torque).epsilon(1e-3));
    }
}

}  // namespace test_axles

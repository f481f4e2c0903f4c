// No unit of length or mass is built in: a scene in units of a power of two has the same bits.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include <carom/carom.hpp>

namespace test_units {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;

/// Units of a scene in those of the world: powers of two, which rounding does not see.
struct Units {
    double metre = 1, kilogram = 1;
    double density() const { return kilogram / (metre * metre); }
};

template <class W>
std::vector<double> places(const W& world, const Units& units) {
    std::vector<double> found;
    for (std::uint32_t i = 0; i < world.body_count(); ++i) {
        const BodyState state = world.state({i, 0});
        found.insert(found.end(), {state.position.x / units.metre, state.position.y / units.metre,
                                   state.angle, state.velocity.x / units.metre});
    }
    return found;
}

/// A heap of boxes and capsules on a segment that turns.
template <class W>
std::vector<double> stirred_heap(const Units& units, int steps) {
    const double m = units.metre;
    const Material rough{.density = units.density(), .friction = 0.5};
    Scene scene;
    scene.gravity = {0, -10 * m};
    scene.walls = Walls{.min = {-4 * m, 0}, .max = {4 * m, 100 * m}, .top = false, .material = rough};
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-1.6 * m, 0}, {1.6 * m, 0}},
               .position = {0, 1.7 * m},
               .angular_velocity = 4,
               .material = rough});
    for (int i = 0; i < 40; ++i)
        scene.add({.shape = i % 2 == 0 ? Shape{Box{0.5 * m, 0.4 * m}} : Shape{Capsule{0.3 * m, 0.2 * m}},
                   .position = {(-3.5 + i % 8 + 0.01 * (i % 5)) * m, (3.6 + 0.8 * (i / 8)) * m},
                   .material = rough});
    W world(scene, {.threads = 1});
    for (int i = 0; i < steps; ++i) world.step(kStep);
    return places(world, units);
}

/// Two arms on hinges, of which the second is bent by 0.8 rad at once, and a pendulum that meets its limit.
template <class W>
std::vector<double> bent_arms(const Units& units, int steps) {
    const double m = units.metre;
    const Material material{.density = units.density()};
    Scene scene;
    scene.gravity = {0, -10 * m};
    const BodyId upper =
        scene.add({.shape = Box{2 * m, 0.3 * m}, .position = {m, 10 * m}, .material = material});
    const BodyId lower =
        scene.add({.shape = Box{m, 0.3 * m}, .position = {2.5 * m, 10 * m}, .material = material});
    scene.add(
        Joint{.b = upper, .kind = RevoluteJoint{.anchor = Vec2{0, 10 * m}, .lower = -0.5, .upper = 0.5}});
    const JointId elbow =
        scene.add(Joint{.a = upper,
                        .b = lower,
                        .kind = RevoluteJoint{.anchor = Vec2{2 * m, 10 * m}, .lower = -3, .upper = 3}});
    W world(scene, {.threads = 1});
    for (int i = 0; i < steps; ++i) {
        if (i == 5) world.set_limits(elbow, 0.8, 1.5);
        world.step(kStep);
        if (i == 15)
            CHECK(world.state(lower).angle - world.state(upper).angle >= doctest::Approx(0.8).epsilon(1e-3));
    }
    return places(world, units);
}

}  // namespace

TEST_CASE_TEMPLATE("a limit that is set elsewhere is reached as soon in any unit of length", W, World,
                   World64) {
    const std::vector<double> expected = bent_arms<W>({}, 120);
    for (const double metre : {0x1p-20, 0x1p-10, 0x1p-3, 0x1p6, 0x1p10}) {
        INFO("units of ", metre, " m");
        CHECK(bent_arms<W>({.metre = metre}, 120) == expected);
    }
    CHECK(bent_arms<W>({.kilogram = 0x1p-10}, 120) == expected);
}

TEST_CASE_TEMPLATE("what an edge that turns throws does not depend on the unit of length", W, World,
                   World64) {
    const std::vector<double> expected = stirred_heap<W>({}, 300);
    for (const double metre : {0x1p-10, 0x1p-3, 0x1p6}) {
        INFO("units of ", metre, " m");
        CHECK(stirred_heap<W>({.metre = metre}, 300) == expected);
    }
    CHECK(stirred_heap<W>({.kilogram = 0x1p10}, 300) == expected);
}

}  // namespace test_units

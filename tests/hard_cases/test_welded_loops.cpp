// Loops of welds and hinges that say more than is needed to hold them rigid: crates, frames. What their
// joints give must be of the size of what strikes them, for break limits are compared with it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <carom/carom.hpp>

namespace test_welded_loops {

using namespace carom;

namespace {

constexpr double kGravity = 10;  // m/s²
constexpr double kDrop = 3;      // m, from the middle to the floor

/// Boxes about a middle that is turned by `tilt` and spins; nothing else.
struct Assembly {
    Scene scene;
    Vec2 middle{0, kDrop};
    double tilt = 0;  // rad
    double spin = 0;  // rad/s
    double mass = 0;  // kg
    std::vector<BodyId> bodies;
    std::vector<double> masses;
    std::vector<JointId> joints;

    Vec2 at(Vec2 p) const {
        const double c = std::cos(tilt), s = std::sin(tilt);
        return {middle.x + c * p.x - s * p.y, middle.y + s * p.x + c * p.y};
    }
    std::size_t box(Vec2 p, double width, double height) {
        const Vec2 place = at(p);
        bodies.push_back(scene.add({.shape = Box{width, height},
                                    .position = place,
                                    .angle = tilt,
                                    .velocity = {-spin * (place.y - middle.y), spin * (place.x - middle.x)},
                                    .angular_velocity = spin,
                                    .material = {.density = 1, .friction = 0.5}}));
        masses.push_back(width * height);
        mass += width * height;
        return bodies.size() - 1;
    }
    template <class Kind>
    void join(std::size_t a, std::size_t b, Vec2 p) {
        joints.push_back(scene.add(Joint{.a = bodies[a], .b = bodies[b], .kind = Kind{.anchor = at(p)}}));
    }

    /// n × n boxes of half a metre, each joined to its neighbours.
    void add_crate(std::size_t n) {
        const double half = 0.25 * static_cast<double>(n - 1);
        const auto place = [&](std::size_t x, std::size_t y) {
            return Vec2{0.5 * static_cast<double>(x) - half, 0.5 * static_cast<double>(y) - half};
        };
        for (std::size_t y = 0; y < n; ++y)
            for (std::size_t x = 0; x < n; ++x) box(place(x, y), 0.5, 0.5);
        for (std::size_t y = 0; y < n; ++y)
            for (std::size_t x = 0; x < n; ++x) {
                const Vec2 p = place(x, y);
                if (x + 1 < n) join<WeldJoint>(y * n + x, y * n + x + 1, {p.x + 0.25, p.y});
                if (y + 1 < n) join<WeldJoint>(y * n + x, y * n + x + n, {p.x, p.y + 0.25});
            }
    }
    /// Four bars around a square; the first corner is a hinge if asked for.
    void add_frame(bool has_hinge) {
        const std::size_t top = box({0, 0.9}, 2, 0.2), bottom = box({0, -0.9}, 2, 0.2),
                          left = box({-0.9, 0}, 0.2, 1.6), right = box({0.9, 0}, 0.2, 1.6);
        if (has_hinge)
            join<RevoluteJoint>(left, top, {-0.9, 0.8});
        else
            join<WeldJoint>(left, top, {-0.9, 0.8});
        join<WeldJoint>(top, right, {0.9, 0.8});
        join<WeldJoint>(right, bottom, {0.9, -0.8});
        join<WeldJoint>(bottom, left, {-0.9, -0.8});
    }
    /// Two bars beside each other that two welds join.
    void add_twice_welded() {
        const std::size_t a = box({-0.5, 0}, 1, 0.5), b = box({0.5, 0}, 1, 0.5);
        join<WeldJoint>(a, b, {0, 0.2});
        join<WeldJoint>(a, b, {0, -0.2});
    }
    /// 2 × 2 boxes, each joined to its neighbours by two hinges.
    void add_hinged_crate() {
        for (const double y : {-0.25, 0.25})
            for (const double x : {-0.25, 0.25}) box({x, y}, 0.5, 0.5);
        for (const double along : {-0.2, 0.2}) {
            join<RevoluteJoint>(0, 1, {0, -0.25 + along}), join<RevoluteJoint>(2, 3, {0, 0.25 + along});
            join<RevoluteJoint>(0, 2, {-0.25 + along, 0}), join<RevoluteJoint>(1, 3, {0.25 + along, 0});
        }
    }
};

/// Largest forces [N] of four seconds, and gap of a joint [m].
struct Forces {
    double of_joints = 0, of_floor = 0, gap = 0;
};

template <class W>
Forces dropped(Assembly assembly) {
    assembly.scene.gravity = {0, -kGravity};
    assembly.scene.add(
        {.type = BodyType::static_body, .shape = Segment{{-50, 0}, {50, 0}}, .material = {.friction = 0.5}});
    W world(assembly.scene, {.threads = 1});
    constexpr double kStep = 1.0 / 60;
    Forces most;
    Vec2 before{};
    for (int i = 0; i < 240; ++i) {
        world.step(kStep);
        Vec2 now{};
        for (std::size_t k = 0; k < assembly.bodies.size(); ++k) {
            const Vec2 v = world.state(assembly.bodies[k]).velocity;
            now.x += assembly.masses[k] * v.x, now.y += assembly.masses[k] * v.y;
        }
        const double of_floor =
            std::hypot(now.x - before.x, now.y - before.y + assembly.mass * kGravity * kStep) / kStep;
        if (i > 0) most.of_floor = std::max(most.of_floor, of_floor);
        before = now;
        for (const JointId joint : assembly.joints) {
            const Vec2 force = world.joint_force(joint);
            most.of_joints = std::max(most.of_joints, std::hypot(force.x, force.y));
        }
        most.gap = std::max(most.gap, world.joint_errors().max);
    }
    return most;
}

constexpr double kMostOfFloor = 3;  // joint's force in that of the floor

}  // namespace

TEST_SUITE_BEGIN("hard cases: welded loops");

TEST_CASE_TEMPLATE("joints of rigid loops that fall on a floor are pulled no harder than they are struck", W,
                   World, World64) {
    for (const int kind : {0, 1, 2, 3, 4, 5})
        for (const double tilt : {0.0, 0.4})
            for (const double spin : {0.0, 6.0}) {
                CAPTURE(kind);
                CAPTURE(tilt);
                CAPTURE(spin);
                Assembly assembly;
                assembly.tilt = tilt, assembly.spin = spin;
                if (kind == 0) assembly.add_crate(2);
                if (kind == 1) assembly.add_crate(3);
                if (kind == 2) assembly.add_frame(false);
                if (kind == 3) assembly.add_frame(true);
                if (kind == 4) assembly.add_twice_welded();
                if (kind == 5) assembly.add_hinged_crate();
                const Forces most = dropped<W>(assembly);
                CHECK(most.of_joints < kMostOfFloor * most.of_floor);
                CHECK(most.gap < 0.02);
            }
}

TEST_CASE_TEMPLATE("a welded crate that spins freely keeps its energy and pulls as the turn asks for", W,
                   World, World64) {
    constexpr double kSpin = 20;  // rad/s
    Assembly assembly;
    assembly.spin = kSpin;
    assembly.add_crate(2);
    assembly.scene.gravity = {};
    assembly.scene.effects.ledger = true;
    W world(assembly.scene, {.threads = 1});
    world.step(1.0 / 60);
    const double before = world.ledger().energy.kinetic + world.ledger().energy.rotational;
    double most = 0;
    for (int i = 0; i < 600; ++i) {
        world.step(1.0 / 60);
        for (const JointId joint : assembly.joints) {
            const Vec2 force = world.joint_force(joint);
            most = std::max(most, std::hypot(force.x, force.y));
        }
    }
    CHECK(world.ledger().energy.kinetic + world.ledger().energy.rotational ==
          doctest::Approx(before).epsilon(1e-4));
    // Each box is drawn to the middle by m w² r; two joints share that, or one has all of it.
    const double whole = 0.25 * kSpin * kSpin * std::hypot(0.25, 0.25);
    CHECK(most < 1.5 * whole);
}

TEST_SUITE_END();

}  // namespace test_welded_loops

// Limits of joints that are set elsewhere in every step: ropes that are reeled in, lifts, arms that are
// raised.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <carom/carom.hpp>

namespace test_moving_limits {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;  // s
/// What moves by a limit begins to in its second step: the first one displaces it.
constexpr double kWayOfAStep = 0.01;  // share

template <class W>
struct Held {
    W world;
    BodyId body;
    JointId joint;

    BodyState state() const { return world.state(body); }
};

template <class W>
Held<W> held(Scene scene, const Body& body, Joint joint) {
    scene.effects.ledger = true;
    const BodyId id = scene.add(body);
    joint.b = id;
    const JointId of = scene.add(joint);
    return {W(scene, {.threads = 1}), id, of};
}

double angular_momentum(const BodyState& state) {  // about the origin, of a mass of 1
    return state.position.x * state.velocity.y - state.position.y * state.velocity.x;
}

}  // namespace

TEST_CASE_TEMPLATE("what circles on a rope that is reeled in keeps its angular momentum", W, World, World64) {
    Scene scene;
    scene.gravity = {};
    auto ball = held<W>(scene, {.shape = Disc{0.3}, .position = {5, 0}, .velocity = {0, 2}, .mass = 1},
                        {.kind = DistanceJoint{.max = 5}});
    const double before = ball.world.ledger().energy.kinetic;
    for (int i = 1; i <= 300; ++i) {
        ball.world.set_limits(ball.joint, 0, 5 - 0.5 * kStep * i);
        ball.world.step(kStep);
    }
    CHECK(std::hypot(ball.state().position.x, ball.state().position.y) == doctest::Approx(2.5).epsilon(1e-4));
    CHECK(angular_momentum(ball.state()) == doctest::Approx(10).epsilon(kWayOfAStep / 2));
    const Ledger ledger = ball.world.ledger();
    CHECK(ledger.energy.kinetic > 4 * before);
    CHECK(ledger.energy_by_cause.joints == doctest::Approx(ledger.energy.kinetic - before).epsilon(1e-3));
    CHECK(std::fabs(ledger.energy_by_cause.unexplained) < 1e-3 * before);
}

TEST_CASE_TEMPLATE("a sled that a winch draws goes on when the winch stops", W, World, World64) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.add({.type = BodyType::static_body, .shape = Segment{{-50, 0}, {50, 0}}});
    auto sled = held<W>(scene, {.shape = Box{1, 1}, .position = {0, 0.5}, .mass = 10},
                        {.kind = DistanceJoint{.anchor_a = {20, 0.5}, .max = 20}});
    for (int i = 1; i <= 180; ++i) {
        sled.world.set_limits(sled.joint, 0, 20 - 2 * kStep * i);
        sled.world.step(kStep);
    }
    CHECK(sled.state().position.x == doctest::Approx(6).epsilon(1e-4));
    for (int i = 0; i < 120; ++i) sled.world.step(kStep);
    CHECK(sled.state().velocity.x == doctest::Approx(2).epsilon(1e-3));
    CHECK(sled.state().position.x == doctest::Approx(10).epsilon(1e-3));
}

TEST_CASE_TEMPLATE("what a lower limit lifts has its velocity, and flies on", W, World, World64) {
    const double gravity = 10, speed = 3;
    Scene scene;
    scene.gravity = {0, -gravity};
    auto lift = held<W>(scene, {.shape = Box{1, 1}, .position = {0, -5}, .mass = 1},
                        {.kind = PrismaticJoint{.axis = {0, 1}, .lower = 0, .upper = 10}});
    int i = 1;
    for (; i <= 60; ++i) {
        lift.world.set_limits(lift.joint, speed * kStep * i, 20);
        lift.world.step(kStep);
        if (i > 1) CHECK(lift.state().velocity.y == doctest::Approx(speed).epsilon(1e-4));
        CHECK(lift.state().position.y == doctest::Approx(-5 + speed * kStep * i).epsilon(1e-4));
    }
    double top = 0;
    const double start = lift.state().position.y;
    for (i = 0; i < 30; ++i) {
        lift.world.step(kStep);
        top = std::fmax(top, lift.state().position.y - start);
    }
    CHECK(top == doctest::Approx(speed * speed / (2 * gravity)).epsilon(0.01));
}

TEST_CASE_TEMPLATE("a limit turns an arm by its speed", W, World, World64) {
    for (const bool is_world_b : {false, true}) {
        Scene scene;
        scene.gravity = {};
        const BodyId arm = scene.add({.shape = Box{4, 0.2}, .position = {2, 0}});
        // The hinge counts the angle of the body against the world, or of the world against the body.
        Joint joint{.kind = RevoluteJoint{.anchor = Vec2{0, 0}, .lower = -10, .upper = 10}};
        (is_world_b ? joint.a : joint.b) = arm;
        const JointId hinge = scene.add(joint);
        W world(scene);
        for (int i = 1; i <= 120; ++i) {
            const double angle = kStep * i;
            world.set_limits(hinge, is_world_b ? -20 : angle, is_world_b ? -angle : 20);
            world.step(kStep);
        }
        CHECK(world.state(arm).angular_velocity == doctest::Approx(1).epsilon(1e-4));
        CHECK(world.state(arm).angle == doctest::Approx(2).epsilon(1e-4));
    }
}

TEST_CASE_TEMPLATE("a winch lifts a crate off the floor", W, World, World64) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.add(
        {.type = BodyType::static_body, .shape = Segment{{-50, 0}, {50, 0}}, .material = {.friction = 0.5}});
    auto crate =
        held<W>(scene, {.shape = Box{1, 1}, .position = {0, 0.5}, .mass = 20, .material = {.friction = 0.5}},
                {.kind = DistanceJoint{.anchor_a = {0, 10}, .anchor_b = {0, 0.5}, .max = 9}});
    for (int i = 1; i <= 240; ++i) {
        crate.world.set_limits(crate.joint, 0, 9 - kStep * i);
        crate.world.step(kStep);
    }
    CHECK(crate.state().velocity.y == doctest::Approx(1).epsilon(1e-3));
    CHECK(crate.state().position.y == doctest::Approx(4.5).epsilon(1e-3));
    for (int i = 0; i < 600; ++i) crate.world.step(kStep);
    CHECK(std::hypot(crate.state().velocity.x, crate.state().velocity.y) < 0.01);
}

TEST_CASE_TEMPLATE("a limit that is set once displaces, and throws nothing", W, World, World64) {
    Scene scene;
    scene.gravity = {};
    auto ball = held<W>(scene, {.shape = Disc{0.3}, .position = {5, 0}}, {.kind = DistanceJoint{.max = 5}});
    ball.world.set_limits(ball.joint, 0, 3);
    for (int i = 0; i < 60; ++i) {
        ball.world.step(kStep);
        CHECK(std::fabs(ball.state().velocity.x) < 1e-6);
    }
    CHECK(ball.state().position.x == doctest::Approx(3).epsilon(1e-4));
    // Nor does the next change, of the other sign.
    ball.world.set_limits(ball.joint, 4, 4);
    ball.world.step(kStep);
    ball.world.set_limits(ball.joint, 2, 2);
    for (int i = 0; i < 60; ++i) ball.world.step(kStep);
    CHECK(std::fabs(ball.state().velocity.x) < 1e-6);
}

TEST_CASE_TEMPLATE("ropes that are swept by lanes are reeled in as others are", W, World, World64) {
    constexpr int kStars = 60, kRopes = 4;
    constexpr double kSpeed = 0.5, kStart = 2, kSpin = 0.5;
    Scene scene;
    scene.gravity = {};
    std::vector<BodyId> ends;
    std::vector<JointId> ropes;
    for (int star = 0; star < kStars; ++star) {
        const Vec2 centre{10.0 * (star % 10), 10.0 * (star / 10)};
        const BodyId hub = scene.add({.shape = Disc{0.2}, .position = centre, .mass = 1});
        for (int i = 0; i < kRopes; ++i) {
            const double angle = 2 * std::numbers::pi * i / kRopes, c = std::cos(angle), s = std::sin(angle);
            ends.push_back(scene.add({.shape = Disc{0.2},
                                      .position = {centre.x + kStart * c, centre.y + kStart * s},
                                      .velocity = {-kStart * kSpin * s, kStart * kSpin * c},
                                      .mass = 1}));
            ropes.push_back(
                scene.add(Joint{.a = hub, .b = ends.back(), .kind = DistanceJoint{.max = kStart}}));
        }
    }
    W world(scene, {.threads = 1});
    for (int i = 1; i <= 120; ++i) {
        for (const JointId rope : ropes) world.set_limits(rope, 0, kStart - kSpeed * kStep * i);
        world.step(kStep);
    }
    REQUIRE(world.plan().joints.find("swept by lanes") != std::string::npos);
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const auto star = static_cast<int>(i) / kRopes;
        const BodyState state = world.state(ends[i]);
        const Vec2 from{state.position.x - 10.0 * (star % 10), state.position.y - 10.0 * (star / 10)};
        const double length = std::hypot(from.x, from.y);
        CHECK(length == doctest::Approx(kStart - 2 * kSpeed).epsilon(5e-3));
        const double along = (from.x * state.velocity.x + from.y * state.velocity.y) / length,
                     momentum = from.x * state.velocity.y - from.y * state.velocity.x;
        CHECK(along == doctest::Approx(-kSpeed).epsilon(0.03));
        CHECK(momentum == doctest::Approx(kStart * kStart * kSpin).epsilon(2 * kWayOfAStep));
    }
}

TEST_CASE("a state that is saved while a limit moves goes on with the same bits") {
    const auto reel = [](auto& ball, int i) {
        ball.world.set_limits(ball.joint, 0, 5 - 0.5 * kStep * i);
        ball.world.step(kStep);
    };
    Scene scene;
    scene.gravity = {0, -10};
    auto ball = held<World>(scene, {.shape = Disc{0.3}, .position = {5, 0}, .velocity = {0, 2}},
                            {.kind = DistanceJoint{.max = 5}});
    for (int i = 1; i <= 20; ++i) reel(ball, i);
    auto other = ball;
    for (int i = 21; i <= 40; ++i) reel(ball, i), reel(other, i);
    CHECK(ball.world.state_hash() == other.world.state_hash());
}

TEST_CASE("a step that ends early is taken again with the limits that it had") {
    constexpr int kMostAsks = 8;
    int asks = 0, stop_at = 0;  // 0: never
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {-20, -50}, .max = {180, 1000}, .top = false};
    for (int i = 0; i < 20'000; ++i)  // a step of them asks several times
        scene.add({.shape = Disc{0.5}, .position = {101 + 1.05 * (i % 70), -49 + 1.05 * (i / 70)}});
    const BodyId ball = scene.add({.shape = Disc{0.3}, .position = {5, 0}, .velocity = {0, 2}});
    const JointId rope = scene.add(Joint{.b = ball, .kind = DistanceJoint{.max = 5}});
    World world(scene, {.threads = 1, .should_stop = [&] { return ++asks == stop_at; }});
    World other(world);
    int latest = 0;  // ask at which a step ended early
    for (int i = 1; i <= 2 * kMostAsks; ++i) {
        for (World* each : {&world, &other}) each->set_limits(rope, 0, 5 - 0.5 * kStep * i);
        asks = 0, stop_at = 1 + i % kMostAsks;
        try {
            world.step(kStep);
        } catch (const Error&) {
            latest = std::max(latest, asks);
            stop_at = 0;
            world.step(kStep);
        }
        stop_at = 0;
        other.step(kStep);
        INFO("step ", i);
        CHECK(world.state(ball).position.x == other.state(ball).position.x);
        CHECK(world.state(ball).velocity.x == other.state(ball).velocity.x);
        CHECK(world.state(ball).velocity.y == other.state(ball).velocity.y);
    }
    REQUIRE(latest > 2);  // behind the start of the joints
}

}  // namespace test_moving_limits

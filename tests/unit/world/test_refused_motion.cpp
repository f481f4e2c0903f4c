// World::set_velocity and set_angular_velocity on bodies that nothing moves.
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <string>

namespace test_refused_motion {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Calls what must be refused; the message says where, what and the remedy, and no bit changes.
template <class Real, class Call>
void check_refused(BasicWorld<Real>& world, const char* where, const char* what, const char* remedy,
                   const Call& call) {
    const std::uint64_t before = world.state_hash();
    const std::size_t columns = world.plan().columns.size();
    std::string message;
    try {
        call();
    } catch (const Error& error) {
        message = error.what();
        CHECK(error.code() == ErrorCode::inconsistent);
    }
    CAPTURE(message);
    CHECK(message.starts_with(where));
    CHECK(message.find(what) != std::string::npos);
    CHECK(message.find(remedy) != std::string::npos);
    CHECK(world.state_hash() == before);
    CHECK(world.plan().columns.size() == columns);
}

}  // namespace

TEST_SUITE("world/refused motion") {
    TEST_CASE_TEMPLATE("a static body takes no velocity and no spin", Real, float, double) {
        Scene scene;
        const BodyId post = scene.add({.type = BodyType::static_body, .shape = Disc{1}, .position = {4, 0}});
        scene.add(disc(0.5, 1, {0, 0}, {1, 0}, 1));
        for (const Solver solver : {Solver::impulse, Solver::soft, Solver::event}) {
            BasicWorld<Real> world(scene, {.solver = solver});
            check_refused(world, "World::set_velocity: ", "velocity [1, -2] m/s but is static", "kinematic",
                          [&] {
                              world.set_velocity(post, {1, -2});
                          });
            check_refused(world, "World::set_angular_velocity: ", "angular velocity 3 rad/s but is static",
                          "kinematic", [&] { world.set_angular_velocity(post, 3); });
            world.set_velocity(post, {}), world.set_angular_velocity(post, 0);  // what it has
            for (int i = 0; i < 300; ++i) world.step(kStep);
            CHECK(world.state(post).position == Vec2{4, 0});
            CHECK(world.state(post).velocity == Vec2{});
            CHECK(world.ledger().energy.kinetic == doctest::Approx(0.5));
        }
    }

    TEST_CASE("a kinematic body takes both and moves at them") {
        Scene scene;
        const BodyId paddle =
            scene.add({.type = BodyType::kinematic_body, .shape = Disc{1}, .position = {4, 0}});
        for (const Solver solver : {Solver::impulse, Solver::soft}) {
            World world(scene, {.solver = solver});
            world.set_velocity(paddle, {1, -2});
            world.set_angular_velocity(paddle, 3);
            for (int i = 0; i < 60; ++i) world.step(kStep);
            CHECK(world.state(paddle).velocity == Vec2{1, -2});
            CHECK(world.state(paddle).angular_velocity == 3);
            CHECK(world.state(paddle).position.x == doctest::Approx(5));
            CHECK(world.state(paddle).angle == doctest::Approx(3));
        }
    }

    TEST_CASE_TEMPLATE("a quarantined body takes no velocity and no spin until it is added anew", Real, float,
                       double) {
        Scene scene;
        const BodyId rogue = scene.add(disc(5, 1, {0.9999e8, 0}, {9e6, 0}, 1));
        scene.add(disc(5, 1, {0, 0}, {1, 0}, 1));
        BasicWorld<Real> world(scene);
        world.step(kStep);
        REQUIRE(world.quarantined().size() == 1);
        check_refused(world, "World::set_velocity: ", "velocity [-1, 0] m/s but was quarantined", "Remove it",
                      [&] {
                          world.set_velocity(rogue, {-1, 0});
                      });
        check_refused(world, "World::set_angular_velocity: ", "angular velocity 2 rad/s but was quarantined",
                      "Remove it", [&] { world.set_angular_velocity(rogue, 2); });
        CHECK(world.state(rogue).velocity == Vec2{});
    }
}

}  // namespace test_refused_motion

#include "support/scenes.hpp"

#include <carom/errors.hpp>
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <string>

namespace test_changing_solver {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

Scene empty_box() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 10}};
    scene.walls->material.restitution = 0.9;
    return scene;
}

Body bouncing(Vec2 position, Vec2 velocity) {
    return {.shape = Disc{0.5}, .position = position, .velocity = velocity, .material = {.restitution = 0.9}};
}

std::string message_of(World& world, Solver solver) {
    try {
        world.set_solver(solver);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_SUITE("world/changing solver") {
    TEST_CASE("a world that was made empty takes a body with friction, a segment and a chain under auto") {
        for (const bool with_walls : {false, true}) {
            CAPTURE(with_walls);
            Scene scene = empty_box();
            if (!with_walls) scene.walls.reset();
            World world(scene);
            CHECK(world.plan().solver == "impulse");
            Body rough = bouncing({5, 5}, {});
            rough.material.friction = 0.5;
            world.add(rough);
            CHECK(world.plan().solver == "soft");
            CHECK(world.plan().solver_reason == "a body that was added has friction");
            world.add({.type = BodyType::static_body, .shape = Segment{{0, 1}, {20, 1}}});
            world.add({.type = BodyType::static_body, .shape = Chain{{{0, 2}, {1, 1}, {2, 2}}}});
            for (int i = 0; i < 300; ++i) world.step(kStep);
            const auto bodies = world.bodies();
            CHECK(world.quarantined().empty());
            CHECK(bodies.count == 3);
        }
    }

    TEST_CASE("an elastic gas that grows rough stays under impulse until something takes its bounce away") {
        Scene scene = empty_box();
        scene.gravity = {};
        scene.walls->material.restitution = 0;  // the discs' counts
        World world(scene);
        const auto rough = [](double x, double restitution) {
            Body body = bouncing({x, 5}, {1, 2});
            body.material = {.friction = 0.5, .restitution = restitution};
            return body;
        };
        world.add(rough(2, 1));
        CHECK(world.plan().solver == "impulse");
        CHECK(world.plan().solver_reason.find("without gravity friction acts in impacts alone") == 0);
        Body post = rough(6, 0);
        post.type = BodyType::static_body, post.velocity = {};
        world.add(post);
        CHECK(world.plan().solver == "impulse");
        for (int i = 0; i < 60; ++i) world.step(kStep);
        world.add(rough(10, 0.9));
        CHECK(world.plan().solver == "soft");
        CHECK(world.plan().solver_reason ==
              "impacts take energy until bodies rest or crowd: a body that was added has restitution 0.9, "
              "below 1");
    }

    TEST_CASE("impulse, asked for, takes friction of any restitution, but neither with gravity nor rolling") {
        Scene scene = empty_box();
        scene.gravity = {};
        World world(scene, {.solver = Solver::impulse});
        Body rough = bouncing({5, 5}, {1, 2});
        rough.material.friction = 0.5;
        world.add(rough);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.plan().solver == "impulse");
        rough.position.x = 12, rough.material.rolling_resistance = 0.1;
        CHECK_THROWS_AS(world.add(rough), Error);
        CHECK(world.body_count() == 1);
        world.set_solver(Solver::automatic);
        CHECK(world.plan().solver == "soft");
        world.set_solver(Solver::impulse);
        CHECK(world.plan().solver == "impulse");
    }

    TEST_CASE(
        "what makes auto take soft for a gas with friction: gravity, a bounce below 1, a segment, "
        "rolling resistance, sleep, sweeps") {
        Scene gas = gas_scene({.count = 20});
        for (Body& body : gas.bodies) body.material.friction = 0.3;
        const auto solver_of = [](const Scene& scene) { return World(scene).plan().solver; };
        CHECK(solver_of(gas) == "impulse");
        const auto with = [&](auto change) {
            Scene scene = gas;
            change(scene);
            return solver_of(scene);
        };
        CHECK(with([](Scene& s) { s.walls->material.friction = 0.5; }) == "impulse");
        CHECK(with([](Scene& s) { s.effects.friction = true; }) == "impulse");
        CHECK(with([](Scene& s) { s.gravity = {0, -1}; }) == "soft");
        CHECK(with([](Scene& s) { s.bodies[7].material.restitution = 0.99; }) == "soft");
        CHECK(with([](Scene& s) { s.bodies[7].material.rolling_resistance = 0.1; }) == "soft");
        CHECK(with([](Scene& s) { s.effects.sleep = true; }) == "soft");
        CHECK(with([](Scene& s) { s.accuracy.iterations = 2; }) == "soft");
        CHECK(with([](Scene& s) {
                  s.add({.type = BodyType::static_body, .shape = Segment{{-1, 0}, {1, 0}}});
              }) == "soft");
    }

    TEST_CASE("a world of auto that grew a floor holds what lies on it") {
        Scene scene;
        scene.gravity = {0, -10};
        World world(scene);
        const BodyId disc = world.add({.shape = Disc{0.5}, .position = {0, 2}});
        for (int i = 0; i < 10; ++i) world.step(kStep);
        CHECK(world.plan().solver == "impulse");
        world.add({.type = BodyType::static_body, .shape = Segment{{-5, 0}, {5, 0}}});
        for (int i = 0; i < 300; ++i) world.step(kStep);
        CHECK(world.plan().solver == "soft");
        CHECK(world.state(disc).position.y == doctest::Approx(0.5).epsilon(0.01));
    }

    TEST_CASE("a solver that was asked for stays, and refuses what it cannot do") {
        World world(empty_box(), {.solver = Solver::impulse});
        Body rough = bouncing({5, 5}, {});
        rough.material.friction = 0.5;
        CHECK_THROWS_AS(world.add(rough), Error);
        CHECK(world.body_count() == 0);
        CHECK(world.plan().solver == "impulse");
    }

    TEST_CASE_TEMPLATE("a change of solver keeps every bit of the state, and the clock", Real, float,
                       double) {
        Scene scene = empty_box();
        for (int i = 0; i < 8; ++i) scene.add(bouncing({2.0 + 2 * i, 4.0 + 0.3 * i}, {3.0 - i, 1.0 * i}));
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 90; ++i) world.step(kStep);
        const std::uint64_t hash = world.state_hash();
        const double time = world.time();
        const auto impacts = world.profile().impacts;
        CHECK(impacts > 0);
        for (const Solver solver : {Solver::soft, Solver::event, Solver::impulse, Solver::automatic}) {
            world.set_solver(solver);
            CHECK(world.state_hash() == hash);
            CHECK(world.time() == time);
            CHECK(world.profile().impacts == impacts);
            CHECK(world.profile().steps == 90);
        }
        CHECK(world.plan().solver == "soft");
        world.set_solver(Solver::impulse);
        CHECK(world.plan().solver_reason == "asked for");
        for (int i = 0; i < 30; ++i) world.step(kStep);
        CHECK(world.profile().steps == 120);
        CHECK(world.profile().impacts > impacts);
    }

    TEST_CASE("sleepers wake when the solver changes, since no other knows sleep") {
        Scene scene = empty_box();
        scene.walls->material.restitution = 0;
        scene.add({.shape = Disc{0.5}, .position = {5, 0.5}});
        World world(scene, {.effects = {.sleep = true}});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        CHECK(world.profile().asleep == 1);
        CHECK(message_of(world, Solver::impulse).find("sleep") != std::string::npos);
        CHECK(world.plan().solver == "soft");
    }

    TEST_CASE("set_solver refuses what the solver cannot do, and says what and what else to take") {
        Scene scene = empty_box();
        Body rough = bouncing({5, 5}, {});
        rough.material.friction = 0.5;
        scene.add(rough);
        World world(scene);
        const std::uint64_t hash = world.state_hash();
        CHECK(message_of(world, Solver::impulse).find("friction 0.5") != std::string::npos);
        CHECK(message_of(world, Solver::pairwise).find("pairwise") != std::string::npos);
        CHECK(message_of(world, Solver::rattle).find("rattle") != std::string::npos);
        CHECK(world.plan().solver == "soft");
        CHECK(world.state_hash() == hash);
    }
}

}  // namespace test_changing_solver

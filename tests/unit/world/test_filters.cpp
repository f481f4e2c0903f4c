// Filters: which bodies touch which, by group, category and mask.
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <carom/carom.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace test_filters {

using namespace carom;

namespace {

constexpr std::uint16_t kRed = 2, kBlue = 4;

/// What of one kind rests on what of the other, if anything holds it.
struct Fall {
    Body falling, floor;
};

/// Height of the centre of what falls, after a second and a half, above a floor whose top is at 0.
double height_of(Body falling, const Body& floor, Solver solver) {
    Scene scene;
    scene.gravity = {0, -10};
    scene.accuracy.solver = solver;
    scene.add(floor);
    falling.position = {0.1, 0.8};
    const BodyId id = scene.add(falling);
    World world(scene);
    for (int step = 0; step < 90; ++step) world.step(1.0 / 60);
    return world.state(id).position.y;
}

bool is_held(const Body& falling, const Body& floor, Solver solver = Solver::soft) {
    return height_of(falling, floor, solver) > 0;
}

Body with(Body body, std::uint16_t category, std::uint16_t mask, std::int32_t group = 0) {
    body.category = category, body.mask = mask, body.group = group;
    return body;
}

const std::vector<Body> kFalling{{.shape = Disc{0.2}}, {.shape = Box{0.4, 0.3}}};
const std::vector<Body> kFloors{
    {.type = BodyType::static_body, .shape = Segment{{-3, 0}, {3, 0}}},
    {.type = BodyType::static_body, .shape = Chain{{{3, 0}, {0, 0}, {-3, 0}}}},
    {.type = BodyType::static_body, .shape = Box{6, 0.5}, .position = {0, -0.25}},
    {.type = BodyType::static_body, .shape = Disc{4}, .position = {0, -4}},
};

}  // namespace

TEST_SUITE("world: filters") {
    TEST_CASE("two bodies touch if each has a category in the other's mask") {
        for (const Body& falling : kFalling)
            for (const Body& floor : kFloors) {
                CAPTURE(falling.shape.index());
                CAPTURE(floor.shape.index());
                CHECK(is_held(falling, floor));
                CHECK(is_held(with(falling, kRed, kBlue), with(floor, kBlue, kRed)));
                CHECK(is_held(with(falling, kRed | kBlue, kBlue), with(floor, kBlue, kRed)));
                CHECK_FALSE(is_held(with(falling, kRed, kRed), with(floor, kBlue, kRed)));
                CHECK_FALSE(is_held(with(falling, kRed, kBlue), with(floor, kBlue, kBlue)));
                CHECK_FALSE(is_held(with(falling, 0, kDefaultMask), floor));
                CHECK_FALSE(is_held(falling, with(floor, kDefaultCategory, 0)));
            }
    }

    TEST_CASE("a group goes before category and mask: below zero never, above zero always") {
        for (const Body& falling : kFalling)
            for (const Body& floor : kFloors) {
                CAPTURE(falling.shape.index());
                CAPTURE(floor.shape.index());
                CHECK(is_held(with(falling, kRed, kRed, 3), with(floor, kBlue, kBlue, 3)));
                CHECK_FALSE(is_held(with(falling, kRed, kRed, 3), with(floor, kBlue, kBlue, 2)));
                CHECK_FALSE(is_held(with(falling, 1, 1, -3), with(floor, 1, 1, -3)));
                CHECK(is_held(with(falling, 1, 1, -3), with(floor, 1, 1, -2)));
            }
    }

    TEST_CASE("a world whose last body that could be met is removed goes on") {
        for (const Body& falling : kFalling) {
            Scene scene;
            scene.gravity = {0, -10};
            Body body = falling;
            body.position = {0, 0.2};
            const BodyId id = scene.add(body), floor = scene.add(kFloors[2]);
            World world(scene);
            for (int step = 0; step < 30; ++step) world.step(1.0 / 60);
            world.remove(floor);
            for (int step = 0; step < 60; ++step) world.step(1.0 / 60);
            CHECK(world.state(id).position.y < -3);
        }
    }

    TEST_CASE("solver impulse lets discs through each other as their filters say, and bounces the others") {
        const auto speed_after = [](std::uint16_t category) {
            Scene scene;
            scene.accuracy.solver = Solver::impulse;
            const Material elastic{.restitution = 1};
            scene.add({.shape = Disc{0.2}, .velocity = {3, 0}, .material = elastic, .mask = kRed});
            const BodyId hit = scene.add(
                {.shape = Disc{0.2}, .position = {1, 0}, .material = elastic, .category = category});
            World world(scene);
            for (int step = 0; step < 60; ++step) world.step(1.0 / 60);
            return world.state(hit).velocity.x;
        };
        CHECK(speed_after(kRed) == doctest::Approx(3));
        CHECK(speed_after(kBlue) == 0);
    }

    TEST_CASE("impulse finds no impact of forbidden pairs in a gas, nor after a deflection") {
        Scene scene;
        scene.accuracy.solver = Solver::impulse;
        scene.walls = Walls{{0, 0}, {4, 4}, true, true, true, true, {.restitution = 1}};
        for (int i = 0; i < 64; ++i)
            scene.add({.shape = Disc{0.1},
                       .position = {0.3 + 0.45 * (i % 8), 0.3 + 0.45 * (i / 8)},
                       .velocity = {i % 2 == 0 ? 2.0 : -1.5, i % 3 - 1.0},
                       .material = {.restitution = 1},
                       .mask = 0});
        World world(scene);
        for (int step = 0; step < 120; ++step) world.step(1.0 / 60);
        CHECK(world.profile().impacts > 0);  // of walls
        const auto bodies = world.bodies();
        for (std::size_t row = 0; row < bodies.count; ++row) {
            const auto first = static_cast<int>(bodies.id[row].index);
            CHECK(std::abs(std::abs(static_cast<double>(bodies.velocity_x[row])) -
                           (first % 2 == 0 ? 2 : 1.5)) < 1e-6);
        }
    }

    TEST_CASE("event refuses filters and says which; auto takes another solver") {
        Scene scene;
        scene.add({.shape = Disc{0.2}, .material = {.restitution = 1}});
        scene.add({.shape = Disc{0.2}, .position = {1, 0}, .material = {.restitution = 1}, .mask = 1});
        CHECK(World(scene).plan().solver == "impulse");
        scene.accuracy.solver = Solver::event;
        CHECK_THROWS_WITH_AS(World{scene}, doctest::Contains("body 1 has mask 1, but the solver \"event\""),
                             Error);
        scene.bodies[1].mask = kDefaultMask;
        CHECK_NOTHROW(World{scene});
    }

    TEST_CASE("a world without filters has no column of them; one with them keeps them in its state") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.add(kFloors[2]);
        scene.add(kFalling[1]);
        const auto has_column = [](const World& world) {
            const auto columns = world.plan().columns;
            return std::any_of(columns.begin(), columns.end(),
                               [](const auto& column) { return column.name == std::string("filter"); });
        };
        World plain(scene);
        CHECK_FALSE(has_column(plain));
        const BodyId ghost = plain.add({.shape = Disc{0.1}, .position = {1, 1}, .mask = 0});
        CHECK(has_column(plain));
        World copy(plain);
        for (int step = 0; step < 60; ++step) plain.step(1.0 / 60), copy.step(1.0 / 60);
        CHECK(plain.state(ghost).position.y < -2);
        CHECK(plain.state_hash() == copy.state_hash());
    }

    TEST_CASE("what does not touch a sleeper does not wake it, and overlaps leave it out") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.effects.sleep = true;
        scene.add(kFloors[2]);
        const BodyId box = scene.add({.shape = Box{0.5, 0.5}, .position = {0, 0.25}});
        World world(scene);
        for (int step = 0; step < 180; ++step) world.step(1.0 / 60);
        REQUIRE(world.is_asleep(box));
        world.add({.shape = Disc{0.2}, .position = {0, 3}, .velocity = {0, -5}, .mask = 0});
        const BodyId lying = world.add({.shape = Disc{0.2}, .position = {1, 0.3}, .mask = kRed});
        for (int step = 0; step < 30; ++step) world.step(1.0 / 60);
        CHECK(world.is_asleep(box));
        CHECK(world.state(lying).position.y < 0);
        CHECK(world.overlaps().max < 1e-3);
    }
    TEST_CASE(
        "a filter that is changed while a world runs lets fall what was held and holds what would fall") {
        for (const Solver solver : {Solver::soft, Solver::impulse})
            for (const Body& falling : kFalling)
                for (const Body& floor : kFloors)
                    for (const bool of_floor : {false, true}) {
                        const bool discs = falling.shape.index() == 0 && floor.shape.index() == 0;
                        if (solver == Solver::impulse && !discs) continue;
                        CAPTURE(falling.shape.index());
                        CAPTURE(floor.shape.index());
                        CAPTURE(of_floor);
                        Scene scene;
                        scene.gravity = {0, -10};
                        scene.accuracy.solver = solver;
                        const BodyId below = scene.add(floor);
                        Body body = falling;
                        body.position = {0.1, 0.8};
                        const BodyId id = scene.add(body);
                        World world(scene);
                        const BodyId changed = of_floor ? below : id;
                        for (int step = 0; step < 60; ++step) world.step(1.0 / 60);
                        CHECK(world.state(id).position.y > 0);
                        world.set_filter(changed, {.mask = 0});
                        CHECK(world.filter(changed) == Filter{.mask = 0});
                        const double speed = world.state(id).velocity.y;
                        world.step(1.0 / 60);
                        CHECK(world.state(id).velocity.y - speed ==
                              doctest::Approx(-10.0 / 60).epsilon(1e-3));
                        for (int step = 0; step < 30; ++step) world.step(1.0 / 60);
                        CHECK(world.state(id).position.y < -0.3);
                        // Back above the floor, it is held again.
                        world.set_filter(changed, {.group = 4});
                        world.set_filter(changed, {});
                        CHECK(world.filter(changed) == Filter{});
                        world.set_position(id, {0.1, 0.8}), world.set_velocity(id, {});
                        for (int step = 0; step < 60; ++step) world.step(1.0 / 60);
                        CHECK(world.state(id).position.y > 0);
                    }
    }

    TEST_CASE("a world whose bodies were all of one group looks for pairs once one has left it") {
        for (const bool leaves : {false, true}) {
            Scene scene;
            const BodyId left =
                scene.add({.shape = Disc{0.5}, .position = {-2, 0}, .velocity = {3, 0}, .group = -1});
            const BodyId right =
                scene.add({.shape = Disc{0.5}, .position = {2, 0}, .velocity = {-3, 0}, .group = -1});
            World world(scene);
            for (int step = 0; step < 5; ++step) world.step(1.0 / 60);
            if (leaves) world.set_filter(right, {.group = -2});
            for (int step = 0; step < 60; ++step) world.step(1.0 / 60);
            CHECK((world.state(left).position.x < world.state(right).position.x) == leaves);
        }
    }

    TEST_CASE("what sleeps on a body wakes when its filter changes") {
        for (const Body& falling : kFalling)
            for (const Body& floor : kFloors)
                for (const bool of_floor : {false, true}) {
                    CAPTURE(falling.shape.index());
                    CAPTURE(floor.shape.index());
                    Scene scene;
                    scene.gravity = {0, -10};
                    scene.effects.sleep = true;
                    const BodyId below = scene.add(floor);
                    Body body = falling;
                    body.position = {0, 0.3}, body.material.friction = 0.5;
                    const BodyId id = scene.add(body);
                    World world(scene);
                    for (int step = 0; step < 400; ++step) world.step(1.0 / 60);
                    CHECK(world.is_asleep(id));
                    world.set_filter(of_floor ? below : id, {.category = 0});
                    CHECK_FALSE(world.is_asleep(id));
                    for (int step = 0; step < 30; ++step) world.step(1.0 / 60);
                    CHECK(world.state(id).position.y < -0.3);
                }
    }

    TEST_CASE_TEMPLATE(
        "a filter that says the same leaves a pile at rest, and a state goes on to the same bits", Real,
        float, double) {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = Walls{.min = {0, 0}, .max = {12, 60}, .material = {.friction = 0.5}};
        for (int i = 0; i < 200; ++i)
            scene.add({.shape = Disc{0.4 + 0.1 * ((i * 7) % 5) / 4},
                       .position = {0.6 + 1.2 * (i % 9), 0.6 + 1.1 * (i / 9)},
                       .material = {.friction = 0.5}});
        BasicWorld<Real> world(scene);
        for (int step = 0; step < 900; ++step) world.step(1.0 / 60);
        const std::uint64_t before = world.state_hash();
        world.set_filter({50, 0}, {});
        CHECK(world.state_hash() == before);
        const auto rms = [&](const BasicWorld<Real>& of) {
            double sum = 0;
            for (std::uint32_t i = 0; i < 200; ++i) {
                const Vec2 v = of.state({i, 0}).velocity;
                sum += v.x * v.x + v.y * v.y;
            }
            return std::sqrt(sum / 200);
        };
        double worst = 0;
        for (std::uint32_t step = 0; step < 60; ++step) {
            // Another category, that all masks have: nothing touches anything else than before.
            const auto bit = static_cast<std::uint16_t>(step % 2 == 0 ? kRed : kDefaultCategory);
            world.set_filter({3 * step, 0}, {.category = bit});
            world.step(1.0 / 60);
            worst = std::max(worst, rms(world));
        }
        test::report("rms speed at most ", worst);
        CHECK(worst < 1e-4);
        std::vector<std::byte> state(world.state_bytes());
        world.save_state(state);
        BasicWorld<Real> other(Scene{});
        other.restore_state(state);
        for (std::uint32_t step = 0; step < 20; ++step)
            for (BasicWorld<Real>* each : {&world, &other}) {
                each->set_filter({7 * step, 0}, {.mask = static_cast<std::uint16_t>(step % 2)});
                each->step(1.0 / 60);
            }
        CHECK(world.state_hash() == other.state_hash());
    }

    TEST_CASE("a filter of a body that is gone is refused, and any under the solver event") {
        Scene scene;
        scene.accuracy.solver = Solver::event;
        const BodyId body = scene.add({.shape = Disc{0.5}});
        World world(scene);
        CHECK_THROWS_WITH_AS(world.set_filter(body, {.group = 2}), doctest::Contains("World::set_filter"),
                             Error);
        CHECK_THROWS_WITH_AS(world.set_filter(body, {.group = 2}), doctest::Contains("no filters"), Error);
        world.set_filter(body, {});
        CHECK(world.filter(body) == Filter{});
        world.remove(body);
        CHECK_THROWS_AS(world.set_filter(body, {}), Error);
        CHECK_THROWS_AS(static_cast<void>(world.filter(body)), Error);
    }
}

}  // namespace test_filters

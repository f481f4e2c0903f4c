#include <doctest/doctest.h>
#include <carom/carom.hpp>

#include <deque>
#include <limits>
#include <random>
#include <vector>

namespace test_handles {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;  // s

Body disc(Vec2 position, Vec2 velocity, double radius = 0.4) {
    Body body;
    body.shape = Disc{radius};
    body.position = position, body.velocity = velocity;
    body.material.restitution = 0.7;
    return body;
}

ErrorCode code_of_row(const World64& world, BodyId id) {
    try {
        world.row(id);
    } catch (const Error& error) {
        return error.code();
    }
    return ErrorCode::not_finite;  // no error
}

}  // namespace

TEST_SUITE("state/handles") {
    TEST_CASE("a handle finds its body wherever its row has gone") {
        Scene scene;
        std::mt19937 random(3);
        std::vector<BodyId> ids;
        for (int i = 0; i < 3000; ++i) {  // enough for rows to be sorted by place
            const double x = static_cast<double>(random() % 100000) * 1e-2;
            const double y = static_cast<double>(random() % 100000) * 1e-2;
            ids.push_back(scene.add(disc({x, y}, {0, 0}, 0.001 * (1 + i % 7))));
        }
        World64 world(scene);
        for (int i = 0; i < 3; ++i) world.step(kStep);
        std::size_t moved = 0;
        for (std::size_t i = 0; i < ids.size(); ++i) {
            moved += world.row(ids[i]) != i;
            CHECK(world.bodies().id[world.row(ids[i])] == ids[i]);
            CHECK(world.state(ids[i]).position.x ==
                  doctest::Approx(scene.bodies[i].position.x).epsilon(1e-3));
        }
        CHECK(moved > 1000);  // or the test shows nothing
    }

    TEST_CASE("a removed body's handle is stale, also when its place is taken again") {
        Scene scene;
        const BodyId first = scene.add(disc({0, 0}, {1, 0}));
        const BodyId second = scene.add(disc({5, 0}, {0, 1}));
        World64 world(scene);
        world.step(kStep);
        world.remove(first);
        CHECK(code_of_row(world, first) == ErrorCode::stale_handle);
        CHECK(world.state(second).velocity == Vec2{0, 1});
        const BodyId third = world.add(disc({9, 9}, {0, 0}));
        CHECK(third.index == first.index);
        CHECK(code_of_row(world, first) == ErrorCode::stale_handle);
        CHECK(world.state(third).position == Vec2{9, 9});
        CHECK(code_of_row(world, BodyId{77, 0}) == ErrorCode::stale_handle);
        CHECK(code_of_row(world, BodyId{}) == ErrorCode::stale_handle);
    }

    TEST_CASE("a thousand bodies come and go every step, and no handle is ever wrong") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls.emplace();
        scene.walls->max = {200, 100};
        World64 world(scene);
        std::deque<BodyId> alive;
        std::mt19937 random(11);
        for (int step = 0; step < 20; ++step) {
            for (int i = 0; i < 1000; ++i) {
                const double x = 1 + static_cast<double>(random() % 19800) * 0.01;
                const double y = 1 + static_cast<double>(random() % 9800) * 0.01;
                alive.push_back(world.add(disc({x, y}, {0, 0}, 0.1 + 0.1 * (i % 4))));
            }
            for (int i = 0; i < 1000 && step > 2; ++i) {
                const BodyId gone = alive.front();
                alive.pop_front();
                world.remove(gone);
                REQUIRE(code_of_row(world, gone) == ErrorCode::stale_handle);
            }
            world.step(kStep);
            REQUIRE(world.body_count() == alive.size());
            for (const BodyId id : alive) REQUIRE(world.bodies().id[world.row(id)] == id);
        }
    }

    TEST_CASE("what is set from outside is there, in the books too, and a wrong value changes nothing") {
        Scene scene;
        const BodyId id = scene.add(disc({0, 0}, {1, 0}));
        scene.effects.ledger = true;
        World64 world(scene);
        world.set_velocity(id, {0, 3});
        world.set_position(id, {2, 2});
        world.set_angular_velocity(id, 4);
        CHECK(world.state(id).velocity == Vec2{0, 3});
        CHECK(world.state(id).position == Vec2{2, 2});
        CHECK(world.state(id).angular_velocity == 4);
        CHECK(world.ledger().energy_by_cause.unexplained == doctest::Approx(0));
        world.step(kStep);
        CHECK(world.state(id).angle == doctest::Approx(4 * kStep));

        const std::uint64_t hash = world.state_hash();
        const double nan = std::numeric_limits<double>::quiet_NaN();
        CHECK_THROWS_AS(world.set_velocity(id, {nan, 0}), Error);
        CHECK_THROWS_AS(world.set_velocity(id, {2 * kLargestSpeed, 0}), Error);
        CHECK_THROWS_AS(world.set_position(id, {0, 2 * kLargestPosition}), Error);
        CHECK_THROWS_AS(world.set_angular_velocity(id, -nan), Error);
        CHECK_THROWS_AS(world.add(disc({nan, 0}, {0, 0})), Error);
        CHECK_THROWS_AS(world.step(-kStep), Error);
        CHECK_THROWS_AS(world.step(nan), Error);
        CHECK(world.state_hash() == hash);
    }
}

}  // namespace test_handles

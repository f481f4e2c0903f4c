// Sensors: bodies that tell what overlaps them, and touch nothing.
#include <doctest/doctest.h>

#include <carom/carom.hpp>

#include <cmath>
#include <vector>

namespace test_sensors {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;

Body sensor(Shape shape, Vec2 position, BodyType type = BodyType::static_body) {
    return {.type = type, .shape = std::move(shape), .position = position, .sensor = true};
}

/// Times at which a body comes into a sensor and leaves it [s], as the events say.
template <class Real = float>
std::vector<double> times(const Scene& scene, BodyId of, BodyId in, int steps, bool* alternates = nullptr) {
    BasicWorld<Real> world(scene);
    std::vector<double> found;
    for (int step = 0; step < steps; ++step) {
        world.step(kStep);
        for (const SensorEvent& event : world.events().sensor) {
            if (!(event.body == of && event.sensor == in)) continue;
            if (alternates) *alternates = *alternates && event.begins == (found.size() % 2 == 0);
            found.push_back(event.time);
        }
    }
    return found;
}

}  // namespace

TEST_SUITE("world: sensors") {
    TEST_CASE("a body comes in and leaves in the steps in which its surface does, whatever the shapes") {
        // Along x at 2 m/s from -2: the front meets the sensor's left side at -0.5, the back leaves at 0.5.
        for (const auto& [shape, half] : {std::pair<Shape, double>{Disc{0.2}, 0.2},
                                          {Box{0.4, 0.1}, 0.2},
                                          {Capsule{0.2, 0.1}, 0.2},
                                          {Polygon{{{-0.2, 0}, {0.2, -0.1}, {0.2, 0.1}}}, 4.0 / 15}})
            for (const auto& [zone, reach] :
                 {std::pair<Shape, double>{Box{1, 1}, 0.5}, {Disc{0.5}, 0.5}, {Capsule{0.6, 0.2}, 0.5}}) {
                const std::size_t kind_of_body = shape.index(), kind_of_zone = zone.index();
                CAPTURE(kind_of_body);
                CAPTURE(kind_of_zone);
                Scene scene;
                const BodyId in = scene.add(sensor(zone, {0, 0}));
                const BodyId of = scene.add({.shape = shape, .position = {-2, 0}, .velocity = {2, 0}});
                bool alternates = true;
                const std::vector<double> found = times(scene, of, in, 150, &alternates);
                REQUIRE(found.size() == 2);
                CHECK(alternates);
                // The polygon's blunt side leads, a third of its length from its centre.
                const double front = shape.index() == Shape(Polygon{}).index() ? 2.0 / 15 : half;
                CHECK(std::abs(found[0] - (2 - reach - front) / 2) < kStep * 1.01);
                CHECK(std::abs(found[1] - (2 + reach + half) / 2) < kStep * 1.01);
            }
    }

    TEST_CASE("a sensor pushes nothing: wherever sensors are, the others move alike, bit for bit") {
        const auto world_with_sensors_at = [](double x) {
            Scene scene;
            scene.gravity = {0, -10};
            scene.walls = Walls{{-3, 0}, {3, 5}};
            for (int i = 0; i < 12; ++i)
                scene.add({.shape = i % 2 == 0 ? Shape(Disc{0.2}) : Shape(Box{0.4, 0.3}),
                           .position = {-2.6 + 0.47 * i, 1 + 0.3 * (i % 3)}});  // none meets another
            scene.add(sensor(Box{1, 1}, {x, 1}));
            scene.add(sensor(Disc{0.5}, {x == 0 ? 0.3 : 2.5, 3}, BodyType::dynamic_body));
            scene.add(sensor(Box{1, 0.2}, {x == 0 ? -0.3 : -2.4, 3}, BodyType::dynamic_body));
            scene.add(sensor(Capsule{1, 0.2}, {x + 1, 1}, BodyType::kinematic_body));
            return World(scene);
        };
        World in = world_with_sensors_at(0), out = world_with_sensors_at(50);
        for (int step = 0; step < 120; ++step) in.step(kStep), out.step(kStep);
        for (std::uint32_t i = 0; i < 12; ++i) {
            CHECK(in.state({i, 0}).position == out.state({i, 0}).position);
            CHECK(in.state({i, 0}).velocity == out.state({i, 0}).velocity);
        }
        for (const std::uint32_t falling : {13u, 14u})  // through the floor of the walls, too
            CHECK(in.state({falling, 0}).position.y == doctest::Approx(3 - 0.5 * 10 * 4).epsilon(1e-3));
        CHECK(in.overlaps().touching == out.overlaps().touching);
    }

    TEST_CASE("what sleeps in a sensor stays in, and wakes and leaves") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.effects.sleep = true;
        scene.add({.type = BodyType::static_body, .shape = Segment{{-5, 0}, {5, 0}}});
        const BodyId box = scene.add({.shape = Box{0.4, 0.4}, .position = {0, 0.2}});
        const BodyId disc = scene.add({.shape = Disc{0.2}, .position = {0.6, 0.2}});
        const BodyId zone = scene.add(sensor(Box{3, 1}, {0, 0.5}));
        World world(scene, {.keep_events = true});
        for (int step = 0; step < 240; ++step) world.step(kStep);
        REQUIRE(world.is_asleep(box));
        REQUIRE(world.is_asleep(disc));
        CHECK(world.sensed(zone) == std::vector<BodyId>{box, disc});
        CHECK(world.events().sensor.size() == 2);
        world.set_position(box, {4, 0.2});
        world.set_position(disc, {-4, 0.2});
        world.step(kStep);
        CHECK(world.sensed(zone).empty());
        CHECK(world.events().sensor.size() == 4);
        world.clear_events();
        CHECK(world.events().sensor.empty());
    }

    TEST_CASE("a sensor that moves finds bodies that sleep, bodies that never move, segments and chains") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.effects.sleep = true;
        const BodyId ground = scene.add({.type = BodyType::static_body, .shape = Segment{{-5, 0}, {5, 0}}});
        const BodyId box = scene.add({.shape = Box{0.4, 0.4}, .position = {0, 0.2}});
        const BodyId post =
            scene.add({.type = BodyType::static_body, .shape = Disc{0.2}, .position = {2, 0.5}});
        Body probe = sensor(Disc{0.2}, {-8, 0.15}, BodyType::kinematic_body);
        probe.velocity = {2, 0};
        const BodyId id = scene.add(probe);
        World world(scene, {.keep_events = true});
        for (int step = 0; step < 480; ++step) world.step(kStep);
        std::vector<BodyId> began, ended;
        for (const SensorEvent& event : world.events().sensor) {
            CHECK(event.sensor == id);
            (event.begins ? began : ended).push_back(event.body);
        }
        CHECK(began == std::vector<BodyId>{ground, box, post});
        CHECK(ended == std::vector<BodyId>{box, post, ground});
        CHECK(world.is_asleep(box));
    }

    TEST_CASE("a bullet does not pass unseen") {
        for (const double speed : {100.0, 1000.0}) {
            Scene scene;
            const BodyId zone = scene.add(sensor(Box{0.05, 1}, {0, 0}));
            const BodyId high = scene.add(sensor(Box{0.05, 1}, {0, 1.1}));
            const BodyId bullet =
                scene.add({.shape = Disc{0.01}, .position = {-7.77, 0.1}, .velocity = {speed, 0}});
            CAPTURE(speed);
            CHECK(times(scene, bullet, zone, 60).size() == 2);
            CHECK(times<double>(scene, bullet, zone, 60).size() == 2);
            CHECK(times(scene, bullet, high, 60).empty());
        }
    }

    TEST_CASE("filters say what a sensor tells of; sensors do not tell of each other") {
        Scene scene;
        Body zone = sensor(Box{1, 1}, {0, 0});
        zone.mask = 2;
        const BodyId in = scene.add(zone);
        scene.add(sensor(Box{1, 1}, {0.2, 0}, BodyType::kinematic_body));
        scene.add({.shape = Disc{0.1}, .position = {0, 0}});
        const BodyId told = scene.add({.shape = Disc{0.1}, .position = {0, 0.3}, .category = 2});
        World world(scene);
        world.step(kStep);
        CHECK(world.sensed(in) == std::vector<BodyId>{told});
    }

    TEST_CASE("what is removed leaves, with the handle it had; a removed sensor lets all go") {
        Scene scene;
        const BodyId zone = scene.add(sensor(Box{1, 1}, {0, 0}));
        const BodyId one = scene.add({.shape = Disc{0.1}, .position = {0, 0}});
        const BodyId two = scene.add({.shape = Disc{0.1}, .position = {0, 0.3}});
        World world(scene);
        world.step(kStep);
        world.remove(one);
        world.step(kStep);
        REQUIRE(world.events().sensor.size() == 1);
        CHECK(world.events().sensor[0].body == one);
        CHECK_FALSE(world.events().sensor[0].begins);
        world.remove(zone);
        world.step(kStep);
        REQUIRE(world.events().sensor.size() == 1);
        CHECK(world.events().sensor[0].body == two);
        CHECK_THROWS_AS(world.sensed(zone), Error);
    }

    TEST_CASE("a copy of a world tells the same; a world that is told not to says nothing") {
        Scene scene;
        scene.gravity = {0, -10};
        const BodyId zone = scene.add(sensor(Box{1, 1}, {0, -2}));
        scene.add({.shape = Disc{0.1}});
        scene.add({.shape = Box{0.1, 0.2}, .position = {0.2, -2}});
        World world(scene);
        for (int step = 0; step < 20; ++step) world.step(kStep);
        World copy(world);
        for (int step = 0; step < 60; ++step) {
            world.step(kStep), copy.step(kStep);
            CHECK(world.sensed(zone) == copy.sensed(zone));
            CHECK(world.events().sensor.size() == copy.events().sensor.size());
        }
        scene.events.sensor = false;
        World silent(scene);
        for (int step = 0; step < 60; ++step) silent.step(kStep);
        CHECK(silent.sensed(zone).empty());
        const auto stages = silent.plan().stages;
        for (const auto& stage : stages) CHECK(stage.name != "sense");
    }

    TEST_CASE("sensors need soft and an area; auto takes soft") {
        Scene scene;
        scene.add(sensor(Disc{0.2}, {0, 0}));
        scene.add({.shape = Disc{0.2}, .position = {1, 0}, .material = {.restitution = 1}});
        CHECK(World(scene).plan().solver == "soft");
        scene.accuracy.solver = Solver::impulse;
        CHECK_THROWS_WITH_AS(World{scene}, doctest::Contains("body 0 has sensor true, but the solver"),
                             Error);
        scene.accuracy.solver = Solver::automatic;
        scene.bodies[0].shape = Segment{};
        CHECK_THROWS_WITH_AS(World{scene}, doctest::Contains("expected a shape with an area"), Error);
    }
}

}  // namespace test_sensors

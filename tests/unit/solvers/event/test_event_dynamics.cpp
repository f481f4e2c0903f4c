// The core of solver `event` against the slow oracle of tests/support, which looks at every pair before every
// impact in long double, and against brute force.
#include "solvers/event/event_dynamics.hpp"

#include "event_scenes.hpp"
#include "support/effort.hpp"
#include "support/event_simulation.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace test_event_dynamics {

using namespace carom;
using namespace carom::test;

namespace {

double largest_distance(const EventDynamics& dynamics, const EventSimulation& oracle) {
    long double largest = 0;
    for (std::size_t i = 0; i < oracle.discs.size(); ++i) {
        const EventDynamics::State state = dynamics.state(i);
        largest = std::max({largest, std::abs(state.position.x - oracle.discs[i].x),
                            std::abs(state.position.y - oracle.discs[i].y)});
    }
    return static_cast<double>(largest);
}

/// A gas of discs with masses, for some collisions each.
Scene small_gas(double smallest, double largest, double restitution, Vec2 gravity) {
    Scene scene = gas_scene({.count = 40,
                             .packing_fraction = 0.3,
                             .restitution = restitution,
                             .smallest_radius = smallest,
                             .largest_radius = largest});
    scene.gravity = gravity;
    for (std::size_t i = 0; i < scene.bodies.size(); ++i)
        scene.bodies[i].mass = 1 + 0.5 * static_cast<double>(i % 5);
    return scene;
}

double kinetic_energy(const EventDynamics& dynamics, const std::vector<EventBody>& bodies) {
    double sum = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i)
        if (bodies[i].inverse_mass > 0)
            sum += length_squared(dynamics.state(i).velocity) / bodies[i].inverse_mass / 2;
    return sum;
}

}  // namespace

TEST_SUITE("solvers/event/event_dynamics") {
    TEST_CASE("a gas follows the oracle, of one size and of many, with gravity and without") {
        for (const double smallest : {0.5, 0.1})
            for (const double restitution : {1.0, 0.9})
                for (const Vec2 gravity : {Vec2{}, Vec2{0, -5}, Vec2{2, 3}}) {
                    CAPTURE(smallest);
                    CAPTURE(restitution);
                    CAPTURE(gravity.y);
                    const Scene scene = small_gas(smallest, 0.5, restitution, gravity);
                    EventSimulation oracle(scene);
                    EventDynamics dynamics;
                    dynamics.load(event_bodies(scene), event_laws(scene));
                    // some two collisions a disc: round-off grows some ten times with each
                    constexpr double kSeconds = 0.8;
                    for (int i = 0; i < 80; ++i) dynamics.advance(kSeconds / 80);
                    oracle.run_until(kSeconds);
                    const EventCounters& counters = dynamics.counters();
                    CHECK(counters.impacts == oracle.pair_impacts + oracle.wall_impacts);
                    CHECK(counters.impacts > 40);
                    CHECK(counters.wall_impacts == oracle.wall_impacts);
                    CHECK(largest_distance(dynamics, oracle) < 1e-9);
                }
    }

    TEST_CASE("where it stops on the way changes nothing but round-off") {
        const Scene scene = small_gas(0.3, 0.5, 1, {0, -3});
        EventDynamics fine, coarse;
        for (EventDynamics* each : {&fine, &coarse}) each->load(event_bodies(scene), event_laws(scene));
        for (int i = 0; i < 1024; ++i) fine.advance(1.0 / 1024);
        coarse.advance(1);
        CHECK(fine.counters().impacts == coarse.counters().impacts);
        for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
            CHECK(fine.state(i).position.x == doctest::Approx(coarse.state(i).position.x).epsilon(1e-9));
            CHECK(fine.state(i).velocity.y == doctest::Approx(coarse.state(i).velocity.y).epsilon(1e-9));
        }
    }

    TEST_CASE(
        "no two discs overlap, ever: dense and loose, equal and 1 : 100 in size, and folded far apart") {
        struct Mix {
            double packing, smallest;
            int large;  // of radius 10 among them
        };
        for (const Mix mix : {Mix{0.65, 0.5, 0}, Mix{0.1, 0.1, 0}, Mix{0.3, 0.1, 3}}) {
            CAPTURE(mix.packing);
            Scene scene =
                gas_scene({.count = 600, .packing_fraction = mix.packing, .smallest_radius = mix.smallest});
            for (Body& body : scene.bodies) body.mass = 1;
            if (mix.large > 0) scene.walls.reset();  // they fly off, some for good
            for (int i = 0; i < mix.large; ++i)
                scene.add(disc(10, 500, {-200.0 + 1000 * i, 5.0 * i}, {40.0 - 200 * i, 0}, 1));
            const std::vector<EventBody> bodies = event_bodies(scene);
            EventDynamics dynamics;
            dynamics.load(bodies, event_laws(scene));
            REQUIRE(!dynamics.find_overlap(0));
            const double energy = kinetic_energy(dynamics, bodies);
            for (int i = 0; i < 50; ++i) {
                dynamics.advance(0.2);
                if (is_effort_reduced() && i % 5 > 0) continue;
                std::vector<Vec2> centres;
                for (std::size_t a = 0; a < bodies.size(); ++a) centres.push_back(dynamics.state(a).position);
                std::size_t overlaps = 0;
                for (std::size_t a = 0; a < bodies.size(); ++a)  // brute force
                    for (std::size_t b = 0; b < a; ++b) {
                        const Vec2 d = centres[a] - centres[b];
                        const double reach = (bodies[a].radius + bodies[b].radius) * (1 - 1e-9);
                        overlaps += !(d.x * d.x + d.y * d.y > reach * reach);  // true of no number, too
                    }
                REQUIRE(overlaps == 0);
            }
            CHECK(dynamics.counters().impacts > 600);
            CHECK(kinetic_energy(dynamics, bodies) == doctest::Approx(energy).epsilon(1e-12));
        }
    }

    TEST_CASE("the pair named as overlapping is the first by row") {
        Scene scene;
        for (int i = 0; i < 40; ++i) scene.add(disc(0.5, 1, {2.0 * i, 0}));
        scene.add(disc(0.5, 1, {20.1, 0}));    // overlaps disc 10
        scene.add(disc(0.5, 1, {60, 0.999}));  // barely overlaps disc 30
        EventDynamics dynamics;
        dynamics.load(event_bodies(scene), event_laws(scene));
        const auto found = dynamics.find_overlap(1e-3);
        REQUIRE(found);
        CHECK(found->a == 10);
        CHECK(found->b == 40);
        CHECK(found->separation == doctest::Approx(-0.9));
        CHECK(!dynamics.find_overlap(1.9));
    }

    TEST_CASE("a disc falls onto a static one and hops over a moving one's path at the exact times") {
        // Straight down on the top of a static disc: the height is h - g t²/2, then a bounce.
        Scene scene;
        scene.gravity = {0, -10};
        Body peg = disc(2, 1, {0, 0}, {}, 1);
        peg.type = BodyType::static_body;
        scene.add(peg);
        scene.add(disc(0.5, 1, {0, 2.5 + 5}, {}, 1));
        EventDynamics dynamics;
        dynamics.load(event_bodies(scene), event_laws(scene));
        dynamics.advance(1.5);  // meets at 1 s with 10 m/s
        CHECK(dynamics.counters().impacts == 1);
        CHECK(dynamics.state(1).position.y == doctest::Approx(2.5 + 5 - 1.25).epsilon(1e-13));
        CHECK(dynamics.state(1).velocity.y == doctest::Approx(5).epsilon(1e-13));
        dynamics.advance(98);  // every two seconds
        CHECK(dynamics.counters().impacts == 50);
    }

    TEST_CASE("discs rain through a board of pegs without touching more than skin") {
        Scene scene;
        scene.gravity = {0, -9.81};
        scene.walls = Walls{.min = {-6, -20}, .max = {6, 20}, .material = bouncy(0.8)};
        for (int row = 0; row < 8; ++row)
            for (int i = -4; i <= 4; ++i) {
                Body peg = disc(0.2, 1, {1.2 * i + 0.6 * (row % 2), -2.0 - 1.5 * row}, {}, 0.7);
                peg.type = BodyType::static_body;
                scene.add(peg);
            }
        for (int i = 0; i < 100; ++i)
            scene.add(disc(0.15, 1, {-5 + 1.05 * (i % 10) + 0.003 * i, 4 + 1.1 * (i / 10)}, {}, 0.7));
        const std::vector<EventBody> bodies = event_bodies(scene);
        EventDynamics dynamics;
        dynamics.load(bodies, event_laws(scene));
        for (int i = 0; i < 60; ++i) {
            dynamics.advance(0.05);
            const auto overlap = dynamics.find_overlap(1e-9);
            if (overlap) {
                CAPTURE(overlap->a);
                CAPTURE(overlap->b);
                CAPTURE(overlap->separation);
                REQUIRE(!overlap);
            }
        }
        CHECK(dynamics.counters().impacts > 500);
    }
}

}  // namespace test_event_dynamics

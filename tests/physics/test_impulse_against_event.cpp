// Solver `event` as the oracle of `impulse`, for more discs than the slow one of tests/support can take.
// `impulse` finds the time of each impact inside its steps, so there is no order in the step length to
// observe: at every step it makes the same impacts, and differs by round-off times what collisions make of
// it.
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>

namespace test_impulse_against_event {

using namespace carom;
using namespace carom::test;

namespace {

Scene with(Scene scene, Solver solver) {
    scene.accuracy.solver = solver;
    return scene;
}

Scene falling_gas() {
    Scene scene = gas_scene({.count = 500, .packing_fraction = 0.3, .smallest_radius = 0.3});
    scene.gravity = {0, -2};
    return scene;
}

double largest_distance(const World64& a, const World64& b) {
    double largest = 0;
    for (std::uint32_t i = 0; i < a.body_count(); ++i) {
        const Vec2 p = a.state({i, 0}).position, q = b.state({i, 0}).position;
        largest = std::max(largest, std::hypot(p.x - q.x, p.y - q.y));
    }
    return largest;
}

}  // namespace

TEST_SUITE("physics/impulse against event") {
    TEST_CASE(
        "on a short horizon impulse makes the same impacts as event at every step length, to round-off") {
        constexpr double kTime = 0.5;  // s: one to two collisions a disc
        World64 exact(with(falling_gas(), Solver::event));
        exact.step(kTime);
        REQUIRE(exact.profile().impacts > 250);
        for (const int steps : {4, 30, 240}) {
            CAPTURE(steps);
            World64 stepped(with(falling_gas(), Solver::impulse), {.threads = 1});
            for (int i = 0; i < steps; ++i) stepped.step(kTime / steps);
            const double distance = largest_distance(exact, stepped);
            report(steps, " steps: farthest apart ", distance, " m");
            CHECK(stepped.profile().impacts == exact.profile().impacts);
            CHECK(distance < 1e-9);
        }
    }

    TEST_CASE("on a long horizon they have the same collision rate, pressure and energy in a cooling gas") {
        Scene scene = gas_scene({.count = 1000, .packing_fraction = 0.3, .restitution = 0.95});
        scene.walls->material.restitution = 1;
        World64 exact(with(scene, Solver::event), {.threads = 1});
        World64 stepped(with(scene, Solver::impulse), {.threads = 1});
        for (int i = 0; i < 600; ++i) exact.step(1.0 / 60), stepped.step(1.0 / 60);
        const auto ratio = [&](auto quantity) { return quantity(stepped) / quantity(exact); };
        const double impacts =
            ratio([](const World64& w) { return static_cast<double>(w.profile().impacts); });
        const double pressure = ratio([](const World64& w) { return w.ledger().wall_impulse; });
        const double energy = ratio([](const World64& w) { return w.ledger().energy.kinetic; });
        report("impulse over event: impacts ", impacts, ", pressure ", pressure, ", energy ", energy);
        CHECK(impacts == doctest::Approx(1).epsilon(0.01));
        CHECK(pressure == doctest::Approx(1).epsilon(0.05));
        CHECK(energy == doctest::Approx(1).epsilon(0.02));
    }
}

}  // namespace test_impulse_against_event

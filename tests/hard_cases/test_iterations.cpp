// What `iterations` says: sweeps over the contacts a substep, where a solver does sweeps.
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

namespace test_iterations {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// A pile that is still on its way down, as hard for the sweeps as it gets.
Scene pile() {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5};
    scene.walls = Walls{.min = {0, 0}, .max = {20, 200}, .top = false, .material = rough};
    Lattice lattice;
    lattice.count_x = 16, lattice.count_y = 25;
    lattice.origin = {0.7, 0.6}, lattice.spacing = {1.2, 1.1};
    lattice.jitter = 0.04;
    lattice.radius_range = RadiusRange{0.4, 0.52};
    lattice.body.material = rough;
    add_lattice(scene, lattice);
    return scene;
}

struct Solved {
    double residual = 0, overlap = 0;  // m/s, mean over the steps; fraction of the smaller radius, at the end
    std::uint64_t hash = 0;
};

template <class Real>
Solved solve(std::optional<int> iterations) {
    BasicWorld<Real> world(pile(), {.solver = Solver::soft, .iterations = iterations});
    CHECK(world.plan().iterations == iterations.value_or(2));
    Solved solved;
    constexpr int kSteps = 180;
    for (int i = 0; i < kSteps; ++i) {
        world.step(kStep);
        solved.residual += world.profile().residual / kSteps;
    }
    CHECK(world.quarantined().empty());
    solved.overlap = world.overlaps().max, solved.hash = world.state_hash();
    report("iterations ", iterations.value_or(0), ": residual ", solved.residual, " m/s, overlap ",
           solved.overlap);
    return solved;
}

}  // namespace

TEST_SUITE("hard cases/iterations") {
    TEST_CASE_TEMPLATE("more iterations leave less to be solved in a pile", Real, float, double) {
        const Solved by_default = solve<Real>({}), two = solve<Real>(2);
        CHECK(by_default.hash == two.hash);
        double before = solve<Real>(1).residual;
        for (const int iterations : {2, 4, 16}) {
            const Solved solved = iterations == 2 ? two : solve<Real>(iterations);
            CAPTURE(iterations);
            CHECK(solved.residual < 0.8 * before);
            CHECK(solved.overlap < 0.06);
            before = solved.residual;
        }
    }

    TEST_CASE("one iteration carries a stack and lets it rest") {
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = floor_at(0);
        for (int i = 0; i < 5; ++i) scene.add(disc(0.5, 1, {0, 0.5 + i}));
        World world(scene, {.solver = Solver::soft, .iterations = 1});
        for (int i = 0; i < 600; ++i) world.step(kStep);
        CHECK(world.overlaps().max < 0.06);
        for (std::uint32_t i = 0; i < 5; ++i) CHECK(std::abs(world.state({i, 0}).velocity.y) < 0.01);
    }

    TEST_CASE("auto takes the solver that does sweeps if more than one is asked for") {
        const Scene gas = gas_scene({.count = 50});
        CHECK(World(gas).plan().solver == "impulse");
        CHECK(World(gas, {.iterations = 1}).plan().solver == "impulse");
        World world(gas, {.iterations = 3});
        CHECK(world.plan().solver == "soft");
        CHECK(world.plan().solver_reason == "3 iterations are asked for");
        CHECK(world.plan().iterations == 3);
        Scene asking = gas;
        asking.accuracy.iterations = 3;
        CHECK(World(asking).plan().iterations == 3);
        CHECK(World(asking, {.iterations = 1}).plan().solver == "impulse");
    }

    TEST_CASE("solvers without sweeps refuse iterations, in a scene, in options and while a world runs") {
        const Scene gas = gas_scene({.count = 50, .packing_fraction = 0.2});
        const auto message_of = [](const auto& call) -> std::string {
            try {
                call();
            } catch (const Error& error) {
                CHECK(error.code() == ErrorCode::inconsistent);
                return error.what();
            }
            return "";
        };
        for (const Solver solver : {Solver::impulse, Solver::event}) {
            const std::string says =
                "the accuracy has iterations 5, but the solver \"" + std::string(name_of(solver)) + "\"";
            CHECK(message_of([&] {
                      World(gas, {.solver = solver, .iterations = 5});
                  }).starts_with("World: " + says));
            Scene asking = gas;
            asking.accuracy.iterations = 5;
            CHECK(message_of([&] { World(asking, {.solver = solver}); }).starts_with("World: " + says));
            asking.accuracy.solver = solver;
            CHECK(message_of([&] { asking.validate(); }).starts_with("Scene: " + says));
            World running(gas, {.iterations = 5});
            running.step(kStep);
            const std::uint64_t before = running.state_hash();
            CHECK(message_of([&] { running.set_solver(solver); }).starts_with("World::set_solver: " + says));
            CHECK(running.state_hash() == before);
            CHECK(running.plan().solver == "soft");
            CHECK(World(gas, {.solver = solver, .iterations = 1}).plan().iterations == 1);
        }
    }

    TEST_CASE("a world that goes on with solver soft does the iterations it was asked for") {
        Scene gas = gas_scene({.count = 50});
        World world(gas, {.solver = Solver::soft, .iterations = 1});
        world.set_solver(Solver::impulse);
        CHECK(world.plan().iterations == 1);
        world.set_solver(Solver::soft);
        CHECK(world.plan().iterations == 1);
    }

    TEST_CASE("a state that is restored, and a copy, do the iterations of the world that was saved") {
        World world(pile(), {.solver = Solver::soft, .iterations = 5}), other(pile());
        for (int i = 0; i < 20; ++i) world.step(kStep);
        std::vector<std::byte> state(world.state_bytes());
        world.save_state(state);
        other.restore_state(state);
        World copy(world);
        for (World* each : {&world, &other, &copy}) {
            for (int i = 0; i < 20; ++i) each->step(kStep);
            CHECK(each->plan().iterations == 5);
            CHECK(each->state_hash() == world.state_hash());
        }
    }
}

}  // namespace test_iterations

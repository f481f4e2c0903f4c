// B10 and B35 of docs/hard-cases.md: no step, tiny steps, one huge step, steps of changing length.
#include "support/hard_case.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/step lengths") {
    TEST_CASE_TEMPLATE("B35: one step of 0.1 to 30 times the usual length leaves a pile at rest", Real, float,
                       double) {
        check_cases<Real>(torture::odd_steps_of_a_pile(extent()));
    }

    TEST_CASE_TEMPLATE("B35: a pile at rest stays so under random steps of 1 to 50 ms", Real, float, double) {
        check_cases<Real>(torture::random_steps_of_a_pile(extent()));
    }

    TEST_CASE_TEMPLATE("B35: of 24 piles at rest few move under long and changing steps", Real, float,
                       double) {
        check_cases<Real>(torture::changing_steps_of_many_piles(extent()));
    }

    TEST_CASE("B35: a pile falls asleep under random steps of 1 to 50 ms") {
        check_cases<float>(torture::random_steps_of_a_pile_that_sleeps(extent()));
    }

    TEST_CASE_TEMPLATE("a step of length zero changes no bit of any body, nor the time", Real, float,
                       double) {
        Scene scene = gas_scene({.count = 50, .smallest_radius = 0.1, .largest_radius = 0.8});
        scene.gravity = {0, -10};
        SUBCASE("solver impulse") {
            scene.accuracy.solver = Solver::impulse;
        }
        SUBCASE("solver soft") {
            scene.accuracy.solver = Solver::soft;
            for (Body& body : scene.bodies) body.material.restitution = 0.5;
        }
        scene.drag = {0.5, 0.5};
        scene.bodies[3].angular_velocity = 2;
        Trial<Real> trial(scene);
        for (int i = 0; i < 5; ++i) {
            const std::uint64_t before = trial.world.state_hash();
            const double time = trial.world.time();
            trial.step(0);
            CHECK(trial.world.state_hash() == before);
            CHECK(trial.world.time() == time);
            trial.step(1.0 / 60);
            CHECK(trial.world.state_hash() != before);
        }
        trial.check();
    }

    TEST_CASE_TEMPLATE("a stack of ten survives steps of a nanosecond", Real, float, double) {
        check_cases<Real>(torture::stacks_under_tiny_steps(extent()), Twin::all_effects);
    }

    TEST_CASE_TEMPLATE("a stack of ten survives a step of half a second", Real, float, double) {
        check_cases<Real>(torture::stacks_under_one_long_step(extent()), Twin::all_effects);
    }

    TEST_CASE_TEMPLATE("a stack of ten survives steps that alternate between 1/30 and 1/240 s", Real, float,
                       double) {
        check_cases<Real>(torture::stacks_under_alternating_steps(extent()), Twin::all_effects);
    }

    TEST_CASE_TEMPLATE("a stack dropped into a shaft comes to rest whole", Real, float, double) {
        check_cases<Real>(torture::stacks_dropped_into_a_shaft(extent()), Twin::all_effects);
    }
}

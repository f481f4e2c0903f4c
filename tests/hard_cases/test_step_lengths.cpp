// B10 and B35 of docs/hard-cases.md: no step, tiny steps, one huge step, steps of changing length.
#include <cmath>

#include "math/random.hpp"
#include "support/hard_case.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

namespace test_step_lengths {

using namespace carom;
using namespace carom::test;

namespace {

/// Discs of .2 to .5 lengths [m] that fall from up to 57 of them onto each other, ten side by side.
Scene falling_discs(double length, std::uint64_t seed) {
    constexpr int kDiscs = 400, kColumns = 10;
    const Material material{.friction = 0.3, .restitution = 0.5};
    Random random(seed);
    Scene scene;
    scene.gravity = {0, -9.8};
    scene.walls = Walls{.min = {0, 0}, .max = {12 * length, 400 * length}, .material = material};
    for (int i = 0; i < kDiscs; ++i) {
        const double x = 0.7 + 1.15 * (i % kColumns) + random.uniform(0, 0.1), y = 2 + 1.4 * (i / kColumns);
        scene.add({.shape = Disc{random.uniform(0.2, 0.5) * length},
                   .position = {x * length, y * length},
                   .material = material});
    }
    return scene;
}

/// The largest mean overlap while they fall and come to rest, as a share of the smaller radius.
/// @param changing  whether steps last 1/240 to 1/30 s by chance in place of 1/60 s, for lengths of 1 m; for
/// others as much longer as a fall over such a length takes
template <class Number>
double overlap_of_fall(double length, std::uint64_t seed, bool changing) {
    BasicWorld<Number> world(falling_discs(length, seed), {.threads = 1});
    Random random(35 + seed);
    const double unit = std::sqrt(length), end = 8 * unit;  // s
    double most = 0;
    while (world.time() < end) {
        world.step(unit * (changing ? random.uniform(1.0 / 240, 1.0 / 30) : 1.0 / 60));
        most = std::fmax(most, world.overlaps().mean);
    }
    return most;
}

}  // namespace

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
        check_cases<Real>(torture::changing_steps_of_many_piles(extent_of_draws<Real>()));
    }

    TEST_CASE("B35: a pile falls asleep under random steps of 1 to 50 ms") {
        check_cases<float>(torture::random_steps_of_a_pile_that_sleeps(extent()));
    }

    // Forces of contacts were means over .05 s while steps changed, whatever the size of the discs: the means
    // lagged behind what small ones needed, and these were pressed into each other by .025 to .034 in the
    // mean.
    TEST_CASE_TEMPLATE("discs of any size bear what falls onto them under changing steps", Real, float,
                       double) {
        for (const double length : {1.0, 0.01})
            for (std::uint64_t seed = 1; seed <= scaled(3u, 1u); ++seed) {
                const double even = overlap_of_fall<Real>(length, seed, false),
                             changing = overlap_of_fall<Real>(length, seed, true);
                report("discs of ", 0.35 * length, " m, seed ", seed, ": mean overlap ", even,
                       " in even steps, ", changing, " in changing ones");
                CHECK(even < 0.012);
                CHECK(changing < 0.012);
            }
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

}  // namespace test_step_lengths

// The published figures of the teaching program that the naive engine reproduces, to the printed digits.
#include <carom/pairwise.hpp>

#include "support/seed_scenes.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace test_pairwise_seed {

using namespace carom;
using namespace carom::test;

namespace {

/// A number as the teaching program prints it.
std::string printed(double value, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

}  // namespace

TEST_SUITE("pairwise/seed") {
    TEST_CASE("scene S0 has mass 8.3, kinetic energy 23.8750 and momentum (4.95, 2.85)") {
        const Pairwise world(seed_scene_s0());
        CHECK(printed(world.total_mass(), 1) == "8.3");
        CHECK(printed(world.kinetic_energy(), 4) == "23.8750");
        CHECK(printed(world.momentum().x, 4) == "4.9500");
        CHECK(printed(world.momentum().y, 4) == "2.8500");
        CHECK(world.rotational_energy() == 0);
    }

    TEST_CASE("a head-on pair of equal masses exchanges its velocities exactly and keeps its momentum") {
        Pairwise world(seed_head_on_pair());
        const double overlap = 0.5 + 0.5 - (world.bodies()[1].x - world.bodies()[0].x);
        CHECK(printed(overlap, 3) == "0.200");
        world.step(kSeedDt);
        const PairwiseBody &a = world.bodies()[0], &b = world.bodies()[1];
        CHECK(a.vx == -2);
        CHECK(b.vx == 2);
        CHECK(a.vy == 0);  // the normal is (1, 0)
        CHECK(b.vy == 0);
        CHECK(world.momentum().x == 0);
        CHECK(world.momentum().y == 0);
        CHECK(a.x ==
              doctest::Approx(1.9 - 2 * kSeedDt).epsilon(1e-15));  // pushed half the overlap, then moved
        CHECK(b.x == doctest::Approx(2.9 + 2 * kSeedDt).epsilon(1e-15));
        CHECK(a.y == 2);
        CHECK(world.counts().contacts == 1);
        CHECK(world.counts().impulses == 1);
    }

    TEST_CASE("the drag of the seed scene keeps 0.98 of the velocity in a step of 0.016 s") {
        CHECK(std::exp(-kSeedDrag * kSeedDt) == doctest::Approx(0.98).epsilon(1e-15));
    }

    TEST_CASE("scene S1 reproduces energy, momentum and the final bodies after 500 steps") {
        struct Printed {
            const char *x, *y, *vx, *vy, *energy, *omega;
        };
        constexpr std::array<Printed, 5> kFinal{{
            {"2.75", "0.41", "-0.00", "-0.03", "0.001", "-0.000"},
            {"5.82", "0.36", "-0.00", "-0.03", "0.001", "-0.000"},
            {"6.94", "0.30", "0.00", "-0.26", "0.035", "-0.000"},
            {"4.86", "0.51", "0.00", "0.14", "0.030", "0.000"},
            {"7.69", "0.25", "0.01", "0.30", "0.037", "0.000"},
        }};
        Pairwise world(seed_scene_s1());
        world.step(kSeedDt);
        const double first_energy = world.kinetic_energy();
        const PairwiseVector first = world.momentum();
        for (int step = 1; step < kSeedSteps; ++step) world.step(kSeedDt);

        CHECK(printed(first_energy, 4) == "33.3359");
        CHECK(printed(world.kinetic_energy(), 4) == "0.1038");
        CHECK(printed(world.kinetic_energy() / first_energy, 4) == "0.0031");
        const PairwiseVector last = world.momentum();
        CHECK(printed(std::hypot(last.x - first.x, last.y - first.y), 4) == "8.3566");

        REQUIRE(world.bodies().size() == kFinal.size());
        for (std::size_t body = 0; body < kFinal.size(); ++body) {
            CAPTURE(body);
            const PairwiseBody& actual = world.bodies()[body];
            CHECK(printed(actual.x, 2) == kFinal[body].x);
            CHECK(printed(actual.y, 2) == kFinal[body].y);
            CHECK(printed(actual.vx, 2) == kFinal[body].vx);
            CHECK(printed(actual.vy, 2) == kFinal[body].vy);
            CHECK(printed(kinetic_energy(actual), 3) == kFinal[body].energy);
            CHECK(printed(actual.omega, 3) == kFinal[body].omega);  // rounding alone, sign included
        }
        CHECK(world.counts().steps == kSeedSteps);
        CHECK(world.counts().pair_tests == 10 * kSeedSteps);
        CHECK(world.time() == doctest::Approx(8).epsilon(1e-12));
    }

    TEST_CASE("0.98 a step, as the seed has it, gives the bits of its drag in 1/s at its step length") {
        PairwiseScene by_step = seed_scene_s1();
        by_step.keep_per_step = 0.98;
        Pairwise a(seed_scene_s1()), b(by_step);
        for (int step = 0; step < kSeedSteps; ++step) a.step(kSeedDt), b.step(kSeedDt);
        for (std::size_t body = 0; body < a.bodies().size(); ++body) {
            CHECK(a.bodies()[body].x == b.bodies()[body].x);
            CHECK(a.bodies()[body].vy == b.bodies()[body].vy);
        }
    }
}

}  // namespace test_pairwise_seed

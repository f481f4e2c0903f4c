// Crowds of shapes of uneven sizes: docs/decisions/0098-turns-around-what-is-restless.md.
#include "support/effort.hpp"
#include "support/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

namespace test_uneven_crowds {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr Material kStone{.friction = 0.5};

/// Boxes and discs of .1 to 1 m half across and of like density, which fall into a box of 40 m.
Scene stones(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(0, 1);
    Scene scene;
    scene.gravity = {0, -9.81};
    scene.walls = Walls{.min = {-20, 0}, .max = {20, 120}, .top = false, .material = kStone};
    for (int i = 0; i < 1500; ++i) {
        const double r = 0.1 * std::pow(10, part(random));
        Body body{.position = {-18 + i % 18 * 2.1, 1.2 + i / 18 * 2.1},
                  .angle = 6 * part(random),
                  .material = kStone};
        if (i % 4 == 0)
            body.shape = Disc{r};
        else
            body.shape = Box{2 * r * (0.6 + 0.4 * part(random)), 2 * r * (0.6 + 0.4 * part(random))};
        scene.add(body);
    }
    return scene;
}

}  // namespace

TEST_SUITE("hard cases: uneven crowds") {
    // A light body between heavy ones kept all contacts in turns, which it did not gain by: 12.2 solves a
    // step.
    TEST_CASE("turns of uneven masses end where they change little, and heaps hold as well") {
        double solves = 0, overlap = 0, largest = 0;
        constexpr int kSteps = 200;
        const int draws = scaled(3, 1);
        for (int seed = 1; seed <= draws; ++seed) {
            World world(stones(static_cast<unsigned>(seed)));
            for (int i = 0; i < 350; ++i) world.step(kStep);
            const std::int64_t before = world.profile().path_solves;
            for (int i = 0; i < kSteps; ++i) world.step(kStep);
            solves += static_cast<double>(world.profile().path_solves - before) / (draws * kSteps);
            overlap += world.overlaps().mean / draws;
            largest = std::max(largest, static_cast<double>(world.overlaps().max));
        }
        report("uneven crowds: ", solves, " solves a step, overlap in the mean ", overlap, ", largest ",
               largest, " inradii");
        CHECK(solves < 10.5);
        CHECK(overlap < 0.02);
        CHECK(largest < 0.8);
    }
}

}  // namespace test_uneven_crowds

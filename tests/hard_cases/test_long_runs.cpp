// B22 of docs/hard-cases.md: a million steps.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>

namespace test_long_runs {

using namespace carom;
using namespace carom::test;

TEST_SUITE("hard cases/long runs") {
    TEST_CASE_TEMPLATE("B22: a stack in a shaft is where it was after a million steps", Real, float, double) {
        const int kSteps = scaled(1'000'000, 50'000), kCount = 4, kSettling = 600;
        constexpr double kRadius = 0.5;
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -10};
        const Material rough{.friction = 0.5};
        scene.walls = Walls{.min = {-0.6, 0}, .max = {0.6, 100}, .top = false, .material = rough};
        for (int i = 0; i < kCount; ++i)
            scene.add({.shape = Disc{kRadius},
                       .position = {i % 2 == 0 ? -0.1 : 0.1, kRadius + 0.99 * i},
                       .material = rough});
        BasicWorld<Real> world(scene, {.threads = 1});
        for (int i = 0; i < kSettling; ++i) world.step(1.0 / 60);
        std::vector<BodyState> settled;
        for (std::uint32_t i = 0; i < kCount; ++i) settled.push_back(world.state({i, 0}));
        for (int i = 0; i < kSteps; ++i) world.step(1.0 / 60);
        double farthest = 0, turned = 0, fastest = 0;
        for (std::uint32_t i = 0; i < kCount; ++i) {
            const BodyState now = world.state({i, 0});
            farthest = std::fmax(farthest, std::hypot(now.position.x - settled[i].position.x,
                                                      now.position.y - settled[i].position.y));
            turned = std::fmax(turned, std::fabs(now.angle - settled[i].angle));
            fastest = std::fmax(fastest, std::hypot(now.velocity.x, now.velocity.y));
        }
        report("moved ", farthest, " m, turned ", turned, " rad, speed ", fastest, " m/s, overlap ",
               world.overlaps().max);
        CHECK(farthest < 1e-3 * 2 * kRadius);
        CHECK(turned < 1e-3);
        CHECK(fastest < 1e-3);
        CHECK(world.overlaps().max < 0.01);
    }
}

}  // namespace test_long_runs

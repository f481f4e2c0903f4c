// Contacts of shapes that do not touch yet (docs/decisions/0042-contacts-that-cannot-close.md): what flies
// side by side is left alone, and what is stopped within a step stops what follows it.
#include "math/random.hpp"
#include "math/vec2_math.hpp"
#include "support/report.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace test_flying_shapes {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s

/// Whether discs around two bodies come together in a step, at a relative velocity.
bool do_meet(Vec2 apart, Vec2 velocity, double reach) {
    const double squared = length_squared(velocity), closing = -dot(apart, velocity);
    const double time = squared > 0 ? std::clamp(closing / squared, 0.0, kStep) : 0;
    return length_squared(apart + time * velocity) <= reach * reach;
}

}  // namespace

TEST_SUITE("hard cases/flying shapes") {
    TEST_CASE_TEMPLATE("shapes that fly side by side, or apart, are no contacts", Real, float, double) {
        for (const double angle : {0.0, 0.4, 1.1}) {
            CAPTURE(angle);
            const Vec2 along{std::cos(angle), std::sin(angle)}, aside{-along.y, along.x};
            const auto at = [&](double x, double y) {
                return Vec2{x * along.x + y * aside.x, x * along.y + y * aside.y};
            };
            Scene scene;
            // A row abreast, 2 cm from each other; 20 m/s are 33 cm in a step.
            for (int i = 0; i < 10; ++i) {
                const Shape shape = i % 2 == 0 ? Shape(Box{1, 1}) : Shape(Capsule{0.5, 0.25});
                scene.add({.shape = shape,
                           .position = at(0, 1.02 * i),
                           .angle = angle,
                           .velocity = {20 * along.x, 20 * along.y}});
            }
            // Two that part.
            scene.add({.shape = Box{1, 1},
                       .position = at(20, 0),
                       .angle = angle,
                       .velocity = {-10 * along.x, -10 * along.y}});
            scene.add({.shape = Box{1, 1},
                       .position = at(21.1, 0),
                       .angle = angle,
                       .velocity = {10 * along.x, 10 * along.y}});
            BasicWorld<Real> world(scene, {.solver = Solver::soft});
            world.step(kStep);
            CHECK(world.profile().contacts == 0);
        }
    }
    // Boxes that fly 200 times their size in a step could each be in the way of each, along the line between
    // them: 3,236 contacts of 200 boxes, 179 now (docs/decisions/0103-bodies-that-rattle.md).
    TEST_CASE_TEMPLATE("shapes far apart are contacts if they come together as they fly or one is stopped",
                       Real, float, double) {
        constexpr int kCount = 60;
        constexpr double kSize = 0.1, kOuter = 0.7072 * kSize, kInner = 0.5 * kSize;  // m, of a box
        Random random(3);
        Scene scene;
        for (int i = 0; i < kCount; ++i)
            scene.add({.shape = Box{kSize, kSize},
                       .position = {random.uniform(0, 8), random.uniform(0, 8)},
                       .angle = random.uniform(0, 1.5),
                       .velocity = {random.uniform(-1200, 1200), random.uniform(-1200, 1200)}});
        // A world with fewer far pairs than bodies takes a step in one flight
        // (docs/decisions/0105-flights-of-a-step.md): there are 1,770 pairs of what flies.
        for (int i = 0; i < 1800; ++i)
            scene.add({.type = BodyType::static_body, .shape = Disc{kSize}, .position = {1000.0 + i, 1000}});
        std::int64_t least = 0, most = 0;
        for (int i = 0; i < kCount; ++i)
            for (int k = 0; k < i; ++k) {
                const Body &a = scene.bodies[static_cast<std::size_t>(i)],
                           &b = scene.bodies[static_cast<std::size_t>(k)];
                const Vec2 apart = b.position - a.position;
                const auto meet = [&](Vec2 velocity, double radius) {
                    return do_meet(apart, velocity, 2 * radius);
                };
                const double near = 0.05 * kInner;  // contacts are wider by .04
                least += meet(b.velocity - a.velocity, kInner - near);
                most += std::sqrt(length_squared(apart)) <= 2 * 5.1 * kOuter ||
                        meet(b.velocity - a.velocity, kOuter + near) || meet(b.velocity, kOuter + near) ||
                        meet(-1.0 * a.velocity, kOuter + near);
            }
        BasicWorld<Real> world(scene, {.solver = Solver::soft});
        world.step(kStep);
        const std::int64_t contacts = world.profile().contacts;
        report(kCount, " boxes that fly 200 sizes: ", contacts, " contacts, between ", least, " and ", most);
        CHECK(least > 20);
        CHECK(contacts >= least);
        CHECK(contacts <= most);
        CHECK(most < 300);
    }
    TEST_CASE_TEMPLATE("what flies far behind another body is stopped by it in the step in which that is",
                       Real, float, double) {
        Scene scene;
        scene.add({.type = BodyType::static_body, .shape = Box{2, 20}, .position = {-1, 0}});
        for (const double x : {3.0, 8.0})  // a gap of 7 radii
            scene.add({.shape = Box{1, 1}, .position = {x, 0}, .velocity = {-1200, 0}});
        BasicWorld<Real> world(scene, {.solver = Solver::soft});
        world.step(kStep);
        for (const std::uint32_t i : {1u, 2u}) {
            CAPTURE(i);
            CHECK(std::abs(world.state({i, 0}).velocity.x) < 1e-4 * 1200);
            CHECK(world.state({i, 0}).position.x == doctest::Approx(i - 0.5).epsilon(0.1));
        }
    }
    TEST_CASE_TEMPLATE("a row of shapes is stopped in the step in which its first one is", Real, float,
                       double) {
        double deepest = 0;
        for (const double speed : {3.0, 20.0, 60.0})
            for (const double restitution : {0.0, 0.5, 1.0})
                for (const double gap : {0.01, 0.05, 0.2}) {
                    CAPTURE(speed);
                    CAPTURE(restitution);
                    CAPTURE(gap);
                    const Material material{.restitution = restitution};
                    Scene scene;
                    scene.add({.type = BodyType::static_body,
                               .shape = Box{20, 2},
                               .position = {0, -1},
                               .material = material});
                    for (int i = 0; i < 6; ++i)
                        scene.add({.shape = Box{1, 1},
                                   .position = {0, 0.55 + (1 + gap) * i},
                                   .velocity = {0, -speed},
                                   .material = material});
                    BasicWorld<Real> world(scene, {.solver = Solver::soft});
                    double most = 0;
                    for (int i = 0; i < 60; ++i) {
                        world.step(kStep);
                        most = std::max(most, world.overlaps().max);
                    }
                    deepest = std::max(deepest, most);
                    CHECK(most < 0.15);  // 0.32 before; what bounces twice in a step
                }
        report("deepest overlap of rows that are stopped: ", deepest, " of the half side");
    }
}

}  // namespace test_flying_shapes

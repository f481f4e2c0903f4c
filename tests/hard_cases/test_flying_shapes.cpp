// Contacts of shapes that do not touch yet (docs/decisions/0042-contacts-that-cannot-close.md): what flies
// side by side is left alone, and what is stopped within a step stops what follows it.
#include "support/report.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s

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

// Bodies that move together, far beyond their margins, to what does not move with them: walls, edges, discs
// that stand still. Whoever lists what a body may reach has to look as far as the flow may carry it.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>

namespace test_flows {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5, kWall = 40;

constexpr double kLarge = 10;  // m, radius of the disc that stands still
constexpr Vec2 kCentre{kWall + kLarge, 12};

constexpr int kColumns = 12, kRows = 20;

enum class Obstacle { wall, edge, disc };

/// A block of discs, a gap between them, that flies to the right.
Scene block(double speed, double turn, Obstacle obstacle) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    const Material rough{.friction = 0.5};
    Lattice lattice;
    lattice.count_x = kColumns, lattice.count_y = kRows, lattice.origin = {0, 0},
    lattice.spacing = {1.3, 1.2};
    lattice.jitter = 0.05;
    lattice.body = {.shape = Disc{kRadius}, .material = rough};
    add_lattice(scene, lattice);
    for (Body& body : scene.bodies)
        body.velocity = {speed - turn * (body.position.y - 12), turn * (body.position.x - 8)};
    if (obstacle == Obstacle::wall)
        scene.walls = Walls{.min = {-100, -100}, .max = {kWall, 200}, .material = rough};
    if (obstacle == Obstacle::edge)
        scene.add({.type = BodyType::static_body,
                   .shape = Segment{{kWall, -100}, {kWall, 200}},
                   .material = rough});
    if (obstacle == Obstacle::disc)
        scene.add(
            {.type = BodyType::static_body, .shape = Disc{kLarge}, .position = kCentre, .material = rough});
    return scene;
}

/// How deep a disc of the block is in the obstacle [m].
template <class Real>
double deepest(const BasicWorld<Real>& world, Obstacle obstacle) {
    const BodyView<Real> bodies = world.bodies();
    double most = -1e9;
    for (std::size_t i = 0; i < bodies.count; ++i) {
        const double x = bodies.position_x[i], y = bodies.position_y[i];
        if (bodies.id[i].index >= kColumns * kRows) continue;  // the obstacle
        const double past =
            obstacle == Obstacle::disc ? kLarge - std::hypot(x - kCentre.x, y - kCentre.y) : x - kWall;
        most = std::fmax(most, past + kRadius);
    }
    return most;
}

}  // namespace

TEST_SUITE("hard cases/flows") {
    TEST_CASE_TEMPLATE("a block that flies into a wall, an edge or a disc is stopped there", Real, float,
                       double) {
        for (const Obstacle obstacle : {Obstacle::wall, Obstacle::edge, Obstacle::disc})
            for (const double speed : {1.0, 5.0, 15.0})
                for (const double turn : {0.0, 0.05}) {
                    if (is_effort_reduced() && speed < 5) continue;  // five times the steps
                    BasicWorld<Real> world(block(speed, turn, obstacle), {.threads = 1});
                    const int steps = static_cast<int>(std::ceil(2.2 * kWall / speed / kStep));
                    double most = -1e9;
                    for (int i = 0; i < steps; ++i) {
                        world.step(kStep);
                        most = std::fmax(most, deepest(world, obstacle));
                    }
                    report("at ", speed, " m/s: deepest ", most / kRadius, " R");
                    CHECK(most > -0.02);          // it came there,
                    CHECK(most < 0.1 * kRadius);  // and no farther
                    CHECK(world.quarantined().empty());
                }
    }
}

}  // namespace test_flows

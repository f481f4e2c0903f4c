// Contacts of shapes with edges that stand are carried on while the shapes hardly move
// (docs/decisions/0102-small-scenes.md): they must say what those that are found anew say, and hold nothing
// where the edge is gone.
#include "math/rotation.hpp"
#include "narrowphase/convex_edge.hpp"
#include "solvers/soft/soft_simulation.hpp"
#include "support/box_scenes.hpp"
#include "support/inside.hpp"
#include "support/report.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

namespace test_shapes_on_edges_at_rest {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s
constexpr int kShapes = 24;
constexpr Material kOfTerrain{.friction = 0.8};

/// Crates and capsules that are dropped a little above a rough terrain, which is no steeper than friction
/// holds.
Scene terrain() {
    Scene scene;
    scene.gravity = {0, -kBoxGravity};
    Chain chain;
    for (int i = 120; i >= 0; --i) {
        const double x = -30 + 0.5 * i;
        chain.points.push_back({x, std::sin(0.2 * x) + 0.04 * jitter_of(static_cast<std::uint64_t>(i))});
    }
    scene.add({.type = BodyType::static_body, .shape = chain, .material = kOfTerrain});
    for (int i = 0; i < kShapes; ++i) {
        const double x = -24 + 2.0 * i;
        Body body{.shape = Box{0.8, 0.6}, .position = {x, std::sin(0.2 * x) + 0.5}, .material = kOfTerrain};
        if (i % 3 == 2) body.shape = Polygon{.vertices = {{-0.5, -0.3}, {0.5, -0.3}, {0.2, 0.4}}};
        if (i % 6 == 1) body.shape = Box{0.7, 0.3};
        scene.add(body);
    }
    return scene;
}

template <class Real>
void run(BasicWorld<Real>& world, int steps) {
    for (int i = 0; i < steps; ++i) world.step(kStep);
}

}  // namespace

TEST_SUITE("hard cases/shapes on edges at rest") {
    // Contacts leave round-off of velocities, and round-off of that: docs/decisions/0102-small-scenes.md.
    TEST_CASE_TEMPLATE("what comes to rest has no velocity that is too small for a normal number", Real,
                       float, double) {
        constexpr double kEpsilon = static_cast<double>(std::numeric_limits<Real>::epsilon());
        const auto inside = inside_of<Real>(terrain(), Solver::soft);
        auto& sim = static_cast<SoftSimulation<Real>&>(*inside);
        std::size_t at_rest = 0, tiny = 0;
        for (int i = 0; i < 600; ++i) {
            sim.step(kStep);
            const double nothing = kEpsilon * kEpsilon * kBoxGravity * sim.substep_dt;  // m/s
            const Bodies<Real>& bodies = sim.world.bodies;
            for (std::size_t row = 0; row < bodies.count; ++row)
                for (const Real v : {bodies.velocity_x[row], bodies.velocity_y[row]})
                    at_rest += v == 0, tiny += v != 0 && std::fabs(static_cast<double>(v)) < 0.99 * nothing;
        }
        report("velocities that are zero: ", at_rest, ", and too small: ", tiny);
        CHECK(at_rest > 600 * kShapes / 2);
        CHECK(tiny == 0);
    }

    TEST_CASE_TEMPLATE("what lies on a terrain is hardly ever found anew, and is as near as it seems", Real,
                       float, double) {
        const auto inside = inside_of<Real>(terrain(), Solver::soft);
        auto& sim = static_cast<SoftSimulation<Real>&>(*inside);
        for (int i = 0; i < 300; ++i) sim.step(kStep);
        const Manifolds<Real>& manifolds = sim.soft.paths.manifolds;
        std::size_t found = 0, all = 0;
        for (int i = 0; i < 60; ++i) {
            sim.step(kStep);
            all += manifolds.live().size();
            for (const std::int32_t contact : manifolds.live()) found += manifolds.is_found(contact);
        }
        REQUIRE(all >= 60 * kShapes);
        report("share of contacts at rest that is found anew: ",
               static_cast<double>(found) / static_cast<double>(all));
        CHECK(static_cast<double>(found) < 0.05 * static_cast<double>(all));

        // What each body's nearest point is apart from the terrain, found anew from where it is.
        const WorldState<Real>& world = sim.world;
        std::vector<std::int32_t> edges(world.edges.edges.size());
        std::iota(edges.begin(), edges.end(), 0);
        for (std::size_t row = 0; row < world.bodies.count; ++row) {
            if (world.bodies.shape[row] < 0) continue;
            const Vec2 centre{world.bodies.position_x[row], world.bodies.position_y[row]};
            std::vector<ChainManifold> anew;
            find_chain_manifolds(placed(world.shapes[world.bodies.shape[row]], centre,
                                        rotation_by(static_cast<double>(world.bodies.angle[row]))),
                                 world.edges.edges, edges, 0.01, anew);
            double exact = 1, carried = 1;  // m
            for (const ChainManifold& each : anew)
                exact = std::min({exact, each.manifold.separation1, each.manifold.separation2});
            for (const std::int32_t contact : manifolds.live()) {
                const ManifoldList<Real>& list = manifolds.list_of(contact);
                const std::size_t i = Manifolds<Real>::place_of(contact);
                if (contact >= 0 || static_cast<std::size_t>(list.a[i]) != row) continue;
                carried = std::min({carried, static_cast<double>(list.memory[i].separation1),
                                    static_cast<double>(list.memory[i].separation2)});
            }
            CAPTURE(row);
            CHECK(std::abs(exact - carried) < 2e-5);
        }
    }

    TEST_CASE_TEMPLATE("what lies on a terrain lies still", Real, float, double) {
        BoxRun<Real> shapes(terrain());
        shapes.steps(600);
        shapes.mark();
        shapes.steps(300);
        CHECK(shapes.farthest_shift() < 1e-4);
        CHECK(shapes.world.overlaps().max < 0.02);
    }

    TEST_CASE_TEMPLATE("what stood on a segment that is taken away falls freely at once", Real, float,
                       double) {
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        std::vector<BodyId> floor;
        for (int i = -1; i <= 1; ++i)
            floor.push_back(scene.add({.type = BodyType::static_body,
                                       .shape = Segment{{4.0 * i + 2, 0}, {4.0 * i - 2, 0}},
                                       .material = kOfTerrain}));
        for (int i = -1; i <= 1; ++i) scene.add(box_at(4 * i, 0.5, 1, 1, 0.8));
        BasicWorld<Real> world(scene);
        run(world, 240);
        const double start = world.state({4, 0}).position.y;
        SUBCASE("put elsewhere") {
            world.set_position(floor[1], {0, -50});
        }
        SUBCASE("removed") {
            world.remove(floor[1]);
        }
        run(world, 12);
        const double fallen = 0.5 * kBoxGravity * 0.2 * 0.2;
        CHECK(start - world.state({4, 0}).position.y == doctest::Approx(fallen).epsilon(0.02));
        for (const std::uint32_t other : {3u, 5u})
            CHECK(std::abs(world.state({other, 0}).position.y - 0.5) < 1e-3);
    }

    TEST_CASE_TEMPLATE("a crate that stood across a joint tips when the segment under its centre is gone",
                       Real, float, double) {
        constexpr double kBeyond = 0.3, kTime = 0.2;  // m, s
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        scene.add({.type = BodyType::static_body, .shape = Segment{{0, 0}, {-4, 0}}, .material = kOfTerrain});
        const BodyId gone = scene.add(
            {.type = BodyType::static_body, .shape = Segment{{4, 0}, {0, 0}}, .material = kOfTerrain});
        scene.add(box_at(kBeyond, 0.5, 1, 1, 0.8));
        BasicWorld<Real> world(scene);
        run(world, 240);
        world.remove(gone);
        run(world, 12);
        // Around the end of the segment that is left.
        const double inertia = 1.0 / 6 + kBeyond * kBeyond + 0.25;  // m², of a kilogram
        const double acceleration = kBoxGravity * kBeyond / inertia;
        CHECK(world.state({2, 0}).angle == doctest::Approx(-0.5 * acceleration * kTime * kTime).epsilon(0.1));
    }

    TEST_CASE_TEMPLATE("what lies on a chain that is put lower falls freely at once", Real, float, double) {
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        scene.add({.type = BodyType::static_body, .shape = Chain{{{9, 0}, {3, 0}, {-3, 0}, {-9, 0}}}});
        for (int i = -1; i <= 1; ++i) scene.add(box_at(4 * i, 0.5, 1, 1, 0.8));
        BasicWorld<Real> world(scene);
        run(world, 240);
        const double start = world.state({2, 0}).position.y;
        world.set_position({0, 0}, {0, -0.2});
        run(world, 6);
        CHECK(start - world.state({2, 0}).position.y ==
              doctest::Approx(0.5 * kBoxGravity * 0.1 * 0.1).epsilon(0.02));
    }

    TEST_CASE_TEMPLATE("others lie on as they did when some are taken away", Real, float, double) {
        BasicWorld<Real> world(terrain());
        run(world, 600);
        std::vector<Vec2> from;
        for (std::uint32_t i = 0; i <= kShapes; ++i) from.push_back(world.state({i, 0}).position);
        for (std::uint32_t gone = 1; gone <= 9; gone += 2) world.remove({gone, 0}), run(world, 30);
        for (std::uint32_t i = 10; i <= kShapes; ++i) {
            const Vec2 at = world.state({i, 0}).position;
            CAPTURE(i);
            CHECK(std::hypot(at.x - from[i].x, at.y - from[i].y) < 1e-4);
        }
    }

    TEST_CASE_TEMPLATE("a crate that is pushed slowly over joints keeps on the ground and at the pusher",
                       Real, float, double) {
        constexpr double kSpeed = 3e-3;  // m/s: 50 um a step
        Scene scene;
        scene.gravity = {0, -kBoxGravity};
        Chain chain;
        for (int i = 60; i >= 0; --i) chain.points.push_back({-3 + 0.1 * i, 0});
        scene.add({.type = BodyType::static_body, .shape = chain, .material = {.friction = 0.5}});
        scene.add(box_at(0, 0.5, 1, 1, 0.5));
        scene.add({.type = BodyType::kinematic_body,
                   .shape = Box{1, 0.5},
                   .position = {-1, 0.5},
                   .velocity = {kSpeed, 0}});
        BasicWorld<Real> world(scene);
        run(world, 3600);
        CHECK(std::abs(world.state({1, 0}).position.x - 60 * kSpeed) < 5e-4);
        CHECK(std::abs(world.state({1, 0}).position.y - 0.5) < 1e-3);
        CHECK(std::abs(world.state({1, 0}).angle) < 1e-3);
    }
}

}  // namespace test_shapes_on_edges_at_rest

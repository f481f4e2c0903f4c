// Piles of rough discs under solver `soft`: overlap, rest, bits, and bodies that come and go. B15 of
// docs/hard-cases.md: discs between walls that leave them no room.
#include "constraints/contact_graph.hpp"
#include "support/books.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/rms_speed.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_piles {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Discs of radius 0.4 to 0.6 on a loose lattice above the floor of a box.
Scene loose_pile(std::int64_t columns, std::int64_t rows) {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.5};
    const double width = 1.3 * static_cast<double>(columns);
    scene.walls = Walls{.min = {0, 0}, .max = {width, 1e4}, .top = false, .material = rough};
    Lattice lattice;
    lattice.count_x = columns, lattice.count_y = rows;
    lattice.origin = {0.65, 0.7}, lattice.spacing = {1.3, 1.3};
    lattice.jitter = 0.04;
    lattice.radius_range = RadiusRange{0.4, 0.6};
    lattice.body.material = rough;
    add_lattice(scene, lattice);
    return scene;
}

}  // namespace

TEST_SUITE("hard cases/piles") {
    TEST_CASE_TEMPLATE("a pile comes to rest with overlaps below one percent", Real, float, double) {
        const int kSteps = scaled(900, 600);
        const Scene scene = loose_pile(20, 20);
        BasicWorld<Real> world(scene);
        CHECK(world.plan().solver == "soft");
        const double start = world.ledger().energy.total();
        for (int i = 0; i < kSteps; ++i) {
            world.step(kStep);
            if (i % 100 == 0) CHECK(world.ledger().energy.total() < (1 + 1e-3) * start);
        }
        const OverlapReport overlaps = world.overlaps();
        report("overlap ", 100 * overlaps.mean, " % mean, ", 100 * overlaps.max, " % max, speed ",
               rms_speed(world), " m/s");
        CHECK(overlaps.touching > 500);
        CHECK(overlaps.mean < 0.01);
        CHECK(overlaps.max < 0.06);
        CHECK(rms_speed(world) < 0.01);
        CHECK(world.quarantined().empty());
    }

    // Without the correction of coarse loads it bounces: 0.19 m/s in single, 0.35 m/s in double precision.
    TEST_CASE_TEMPLATE("a pile of 60 rows that is dropped does not bounce, and its ledger closes", Real,
                       float, double) {
        constexpr double kMark = 0.1;  // m/s
        WorldOptions options;
        options.effects.ledger = true;
        BasicWorld<Real> world(loose_pile(60, 60), options);
        double fastest = 0;
        for (int i = 0; i < 450; ++i) {
            world.step(kStep);
            if (i >= 330) fastest = std::fmax(fastest, rms_speed(world));
        }
        report("speed ", fastest, " m/s, then ", rms_speed(world), " m/s, overlap ",
               100 * world.overlaps().mean, " % mean, ", 100 * world.overlaps().max, " % max");
        CHECK(fastest < kMark);
        CHECK(world.overlaps().mean < 0.01);
        CHECK(world.overlaps().max < 0.06);
        check_books_close(world);
    }

    TEST_CASE_TEMPLATE("a large pile that lands has the same bits for any number of threads", Real, float,
                       double) {
        const Scene scene = loose_pile(100, 50);
        const auto hash = [&](int threads) {
            WorldOptions options;
            options.threads = threads;
            BasicWorld<Real> world(scene, options);
            for (int i = 0; i < 150; ++i) world.step(kStep);
            return world.state_hash();
        };
        const std::uint64_t expected = hash(1);
        CHECK(hash(2) == expected);
        CHECK(hash(3) == expected);
    }

    // Chunks of rows are rounded up to whole blocks: of 128 chunks of 1,040 rows the last would be empty.
    TEST_CASE_TEMPLATE("as many discs as make the last chunk of rows empty fall freely", Real, float,
                       double) {
        BasicWorld<Real> world(loose_pile(410, 320), {.solver = Solver::soft});
        const int steps = 2;
        for (int i = 0; i < steps; ++i) world.step(kStep);
        double off = 0;
        for (const Real speed : world.bodies().velocity_y)
            off = std::fmax(off, std::fabs(speed + 10 * steps * kStep));
        CHECK(world.body_count() == 131200);
        CHECK(off < 1e-6);
    }

    TEST_CASE_TEMPLATE("friction that is forced on with coefficients of zero changes no bit", Real, float,
                       double) {
        Scene scene = loose_pile(8, 8);
        for (Body& body : scene.bodies) body.material.friction = 0;
        scene.walls->material.friction = 0;
        scene.accuracy.solver = Solver::soft;
        BasicWorld<Real> without(scene);
        WorldOptions options;
        options.effects.friction = options.effects.rotation = true;
        BasicWorld<Real> with(scene, options);
        for (int i = 0; i < 200; ++i) without.step(kStep), with.step(kStep);
        CHECK(with.state_hash() == without.state_hash());
    }

    TEST_CASE_TEMPLATE("contacts keep what they carry when other bodies come and go", Real, float, double) {
        Scene scene = loose_pile(8, 8);
        BasicWorld<Real> world(scene);
        for (int i = 0; i < 600; ++i) world.step(kStep);
        const double still = rms_speed(world);
        // Far above the pile: what is added and removed each step must not disturb it.
        for (int i = 0; i < 100; ++i) {
            const BodyId guest = world.add({.shape = Disc{0.5}, .position = {5, 500}});
            world.step(kStep);
            world.remove(guest);
        }
        report("speed ", still, " m/s before, ", rms_speed(world), " m/s after");
        CHECK(rms_speed(world) < 0.01);
        CHECK(world.overlaps().max < 0.06);
    }

    TEST_CASE_TEMPLATE("contacts that find no colour are not lost: a disc hit from all sides at once", Real,
                       float, double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        constexpr double kLarge = 20, kSmall = 0.1, kSpeed = 1, kGap = 0.2;
        constexpr int kCount = 150;  // more than there are colours
        scene.add({.shape = Disc{kLarge}, .mass = 1000});
        for (int i = 0; i < kCount; ++i) {
            const double angle = 2 * std::numbers::pi * i / kCount, from = kLarge + kSmall + kGap;
            const Vec2 out{std::cos(angle), std::sin(angle)};
            scene.add({.shape = Disc{kSmall},
                       .position = {from * out.x, from * out.y},
                       .velocity = {-kSpeed * out.x, -kSpeed * out.y}});
        }
        BasicWorld<Real> world(scene);
        std::int64_t overflow = 0;
        for (int i = 0; i < 30; ++i) {
            world.step(kStep);
            overflow = std::max(overflow, world.profile().overflow);
        }
        const auto colours = static_cast<std::int64_t>(ContactGraph<Real>::kColours);
        CHECK(overflow == kCount - colours);  // the others have one each
        double nearest = 1e9, fastest = 0;
        for (std::uint32_t i = 1; i <= kCount; ++i) {
            const BodyState state = world.state({i, 0});
            nearest = std::fmin(nearest, std::hypot(state.position.x, state.position.y));
            fastest = std::fmax(fastest, std::hypot(state.velocity.x, state.velocity.y));
        }
        report("nearest ", nearest - kLarge - kSmall, " m, fastest ", fastest, " m/s");
        CHECK(nearest > kLarge + 0.99 * kSmall);
        CHECK(fastest < 1e-3 * kSpeed);
    }
    TEST_CASE_TEMPLATE("B15: 25 x 25 discs that fill a box stay where they are", Real, float, double) {
        for (const double friction : {0.0, 0.5}) {
            CAPTURE(friction);
            constexpr int kSide = 25;
            constexpr double kRadius = 0.1;
            Scene scene;
            scene.gravity = {0, -10};
            const Material material{.friction = friction};
            scene.walls = Walls{
                .min = {0, 0}, .max = {2 * kSide * kRadius, 2 * kSide * kRadius + 1}, .material = material};
            for (int i = 0; i < kSide * kSide; ++i)
                scene.add({.shape = Disc{kRadius},
                           .position = {(2 * (i % kSide) + 1) * kRadius, (2 * (i / kSide) + 1) * kRadius},
                           .material = material});
            BasicWorld<Real> world(scene);
            for (int i = 0; i < 600; ++i) world.step(kStep);
            double fastest = 0, farthest = 0;
            for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
                const BodyState state = world.state({i, 0});
                const Vec2 from = scene.bodies[i].position;
                fastest = std::fmax(fastest, std::hypot(state.velocity.x, state.velocity.y));
                farthest =
                    std::fmax(farthest, std::hypot(state.position.x - from.x, state.position.y - from.y));
            }
            report("B15: friction ", friction, ": fastest ", fastest, " m/s, moved ", farthest / kRadius,
                   " radii, overlap ", world.overlaps().max);
            CHECK(fastest < 1e-3);
            CHECK(farthest < 0.05 * kRadius);
            CHECK(world.overlaps().max < 0.01);
        }
    }
}

}  // namespace test_piles

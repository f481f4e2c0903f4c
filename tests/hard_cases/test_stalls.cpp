// No step stalls: what a step solves is bounded by its bodies and contacts, whatever these do.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "math/random.hpp"
#include "math/vec2_math.hpp"
#include "support/effort.hpp"
#include "support/falling_grains.hpp"
#include "support/other_order.hpp"
#include "support/report.hpp"

namespace test_stalls {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Discs and capsules that fall into a box, half of them at random 1,000 times heavier, that resist rolling.
Scene heap_of_uneven_rollers(int count, double rolling) {
    Random random(7);
    const auto draw = [&](double low, double high) {
        return low + (high - low) * static_cast<double>(random.next() % 1000003) / 1000003.0;
    };
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {10, 1000}, .material = {.friction = 0.5}};
    for (int i = 0; i < count; ++i) {
        Body body{.position = {0.6 + i % 9 * 1.1, 0.6 + i / 9 * 1.1},
                  .angle = draw(0, std::numbers::pi),
                  .material = {.friction = 0.5, .rolling_resistance = rolling}};
        if (draw(0, 1) < 0.5)
            body.shape = Disc{0.45};
        else
            body.shape = Capsule{0.4, 0.25};
        body.material.density = draw(0, 1) < 0.5 ? 1 : 1000;
        scene.add(body);
    }
    return scene;
}

/// A bar on a hinge of the world, which a motor turns among boxes that have fallen around it.
Scene stirred_boxes() {
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {-8, -8}, .max = {8, 100}, .material = {.friction = 0.1}};
    const BodyId bar = scene.add({.shape = Box{0.6, 14}, .material = {.density = 5}});
    scene.add(
        Joint{.b = bar, .kind = RevoluteJoint{.anchor = Vec2{}, .motor_speed = 3, .max_motor_torque = 1e5}});
    for (int i = 0; i < 900; ++i) {
        const double side = i % 2 == 0 ? -1 : 1;
        scene.add({.shape = Box{0.35, 0.35},
                   .position = {side * (0.6 + 0.45 * (i / 2 % 16)), -7.7 + 0.45 * (i / 32)},
                   .material = {.density = 0.25, .friction = 0.1}});
    }
    return scene;
}

/// Pairs of heavy elastic discs that close on a light one between them, and a gas far away. By Galperin's
/// billiard a pair and its light disc have some pi / 2 sqrt(M / m) impacts, 50,000, before it turns back.
struct Traps {
    static constexpr int kTraps = 3, kDiscs = 60;  // discs of the gas
    Scene scene;
    std::vector<BodyId> gas;

    Traps() {
        scene.walls = Walls{.min = {0, 0}, .max = {40, 100}, .material = {.restitution = 1}};
        const Material elastic{.restitution = 1};
        for (int trap = 0; trap < kTraps; ++trap) {
            const Vec2 middle{20, 10 + 5.0 * trap};
            for (const double side : {-1.0, 1.0})
                scene.add({.shape = Disc{1},
                           .position = middle + Vec2{side * 1.11, 0},
                           .velocity = {-side, 0},
                           .mass = 1e9,
                           .material = elastic});
            scene.add({.shape = Disc{0.1}, .position = middle, .mass = 1, .material = elastic});
        }
        for (int i = 0; i < kDiscs; ++i)
            gas.push_back(scene.add({.shape = Disc{0.45},
                                     .position = {1 + i % 10 * 1.0, 90.5 + i / 10 * 1.0},
                                     .velocity = {30 * std::cos(2.4 * i), 30 * std::sin(2.4 * i)},
                                     .material = elastic}));
        scene.accuracy.solver = Solver::soft;
    }
    double energy_of_gas(const World64& world) const {
        double sum = 0;  // times two over the mass, m²/s²
        for (const BodyId id : gas) sum += length_squared(world.state(id).velocity);
        return sum;
    }
};

/// The most solves of contacts of shapes in a step.
template <class Number>
std::int64_t most_solves(const Scene& scene, int steps) {
    BasicWorld<Number> world(scene, {.threads = 1});
    std::int64_t most = 0;
    for (int step = 0; step < steps; ++step) {
        const std::int64_t before = world.profile().path_solves;
        world.step(kStep);
        most = std::max(most, world.profile().path_solves - before);
    }
    return most;
}

}  // namespace

TEST_SUITE("hard cases/stalls") {
    // A disc may touch whatever it can reach in a step: 130 others here, all of which were contacts that
    // sweeps go over. docs/decisions/0105-flights-of-a-step.md.
    TEST_CASE_TEMPLATE("a crowd of grains that falls far in a step has few contacts a body", Number, float,
                       double) {
        constexpr double kLongStep = 1.0 / 30;  // s
        const int count = scaled(1000, 400), steps = 30;
        const Scene scene = grains_that_fall(count);
        BasicWorld<Number> world(scene, {.threads = 1}), other(scene, in_other_order({}));
        std::optional<BasicWorld<Number>> restored;
        std::int64_t contacts = 0;
        double overlap = 0;
        for (int step = 0; step < steps; ++step) {
            world.step(kLongStep), other.step(kLongStep);
            if (restored) restored->step(kLongStep);
            if (step == steps / 4) restored.emplace(world);
            contacts = std::max(contacts, world.profile().contacts);
            overlap = std::fmax(overlap, world.overlaps().mean);
        }
        report(count, " grains: at most ", contacts, " contacts, mean overlap ", overlap);
        CHECK(contacts < 8 * count);
        CHECK(overlap < 0.03);
        CHECK(world.time() == doctest::Approx(steps * kLongStep).epsilon(1e-12));
        CHECK(world.quarantined().empty());
        const BodyView<Number> bodies = world.bodies();
        for (std::size_t row = 0; row < bodies.count; ++row) {
            CHECK(std::fabs(static_cast<double>(bodies.position_x[row]) - 0.048) < 0.048);
            CHECK(std::fabs(static_cast<double>(bodies.position_y[row]) - 0.65) < 0.65);
        }
        CHECK(world.state_hash() == other.state_hash());
        CHECK(world.state_hash() == restored->state_hash());
    }

    TEST_CASE("a step in flights that is interrupted ends with the flight before, and the world goes on") {
        constexpr double kLongStep = 1.0 / 30;  // s
        constexpr int kFlights = 64;            // at most in a step: all parts of one are so many of these
        int asked = 0, patience = std::numeric_limits<int>::max();
        World world(grains_that_fall(400), {.threads = 1, .should_stop = [&] { return ++asked > patience; }});
        for (int step = 0; step < 13; ++step) world.step(kLongStep);
        int parts = 0, ends_within = 0;
        for (patience = 1; parts < kFlights; ++patience) {
            World copy(world);
            asked = 0;
            try {
                copy.step(kLongStep);
            } catch (const Error& error) {
                CHECK(error.code() == ErrorCode::interrupted);
            }
            const double done = kFlights * (copy.time() - world.time()) / kLongStep;
            const int now = static_cast<int>(std::lround(done));
            CHECK(done == doctest::Approx(now));
            CHECK(now >= parts);
            ends_within += now > 0 && now < kFlights ? 1 : 0;
            parts = now;
            const double time = copy.time();
            asked = -1'000'000;
            copy.step(kLongStep);
            CHECK(copy.time() == doctest::Approx(time + kLongStep));
            CHECK(copy.quarantined().empty());
        }
        report("interrupted within the step ", ends_within, " times of ", patience - 1);
        CHECK(ends_within > 0);
    }

    // Shorter flights would make no fewer pairs where bodies lie in one place.
    TEST_CASE("a step of a crowd in one place finds its pairs once") {
        constexpr int kDiscs = 120;
        Scene scene;
        scene.effects.friction = true;
        for (int i = 0; i < kDiscs; ++i)
            scene.add({.shape = Disc{0.5}, .position = {1e-3 * i, 0}, .material = {.friction = 0.3}});
        World world(scene, {.threads = 1});
        for (int step = 1; step <= 10; ++step) {
            world.step(kStep);
            if (step == 1) CHECK(world.profile().candidate_pairs > 10 * kDiscs);
            CHECK(world.profile().rebuilds <= step);
        }
    }

    // A substep solves paths once, and up to five times more where the world has gained energy; each is four
    // solves with rolling resistance. The turns of what is uneven are 31 in a substep and 124 in a step at
    // most, but for rounding, a solve each: docs/decisions/0086-steps-that-stall.md. They were seven.
    TEST_CASE_TEMPLATE("a heap of uneven masses that roll solves its contacts a bounded number of times",
                       Number, float, double) {
        constexpr int kTurns = 124;
        for (const double rolling : {0.0, 0.3})
            for (const int substeps : {4, 30}) {
                Scene scene = heap_of_uneven_rollers(72, rolling);
                scene.accuracy.substeps = substeps;
                const std::int64_t most = most_solves<Number>(scene, scaled(150, 60));
                report("rolling resistance ", rolling, ", ", substeps, " substeps: at most ", most,
                       " solves in a step");
                CHECK(most <= 6 * substeps * (rolling > 0 ? 4 : 1) + kTurns + substeps);
            }
    }

    // A step had 14,000 impacts of each trap: docs/decisions/0103-bodies-that-rattle.md has the bound.
    TEST_CASE("light discs that rattle between heavy ones take no more impacts than a step has for all") {
        const Traps traps;
        World64 world(traps.scene, {.threads = 1});
        const double start = world.ledger().energy.total(), of_gas = traps.energy_of_gas(world);
        const auto bodies = static_cast<std::int64_t>(traps.scene.bodies.size());
        std::int64_t most = 0;
        for (int step = 0; step < 30; ++step) {
            const std::int64_t before = world.profile().impacts;
            world.step(kStep);
            most = std::max(most, world.profile().impacts - before);
            CHECK(world.ledger().energy.total() <= (1 + 1e-9) * start);
        }
        report("three rattling discs and a gas of 60: at most ", most, " impacts in a step");
        CHECK(most > 4096);  // they do rattle
        // What rattles has up to 100 more as it leaves, of which each takes .3 of 66.
        CHECK(most <= ((1 << 17) + 512 * bodies) / 16 + 300 * Traps::kTraps);
        CHECK(traps.energy_of_gas(world) == doctest::Approx(of_gas).epsilon(1e-12));
    }

    // Contacts were solved up to four times more in turns with the joint, and three times without:
    // docs/decisions/0091-wild-and-restless-crowds.md. What is bounded in energy is solved once more.
    TEST_CASE("a motor that stirs a crowd of shapes has its contacts solved about once a substep") {
        World world(stirred_boxes(), {.threads = 1});
        for (int step = 0; step < 60; ++step) world.step(kStep);
        constexpr int kSteps = 60;
        const Profile then = world.profile();
        double hinge = 0;  // m, the largest error
        for (int step = 0; step < kSteps; ++step) {
            world.step(kStep);
            hinge = std::max(hinge, world.joint_errors().max);
        }
        const Profile profile = world.profile();
        const auto substeps = static_cast<std::int64_t>(kSteps * world.plan().substeps);
        const std::int64_t solves = profile.path_solves - then.path_solves;
        report("a stirred crowd: ", solves, " solves in ", substeps, " substeps, ", profile.contacts,
               " contacts, hinge off by ", hinge, " m, overlap ", world.overlaps().mean, " in the mean");
        CHECK(profile.contacts > 1024);
        CHECK(solves < substeps + substeps / 2);
        CHECK(hinge < 1e-3);
        CHECK(world.overlaps().mean < 0.1);
    }
}

}  // namespace test_stalls

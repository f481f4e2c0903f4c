// B39 of docs/hard-cases.md for convex shapes: worlds of boxes, planks, capsules, polygons and compounds that
// are touched in every step. docs/decisions/0031-touched-worlds.md.
#include "math/random.hpp"
#include "math/vec2_math.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/touches.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace test_touched_shapes {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kWidth = 20;
constexpr int kBodies = 300, kColumns = 13;
constexpr Material kRough{.friction = 0.5};

/// One of the shapes that a pile has, half a metre in size or a plank.
Shape shape_of(int number, bool with_compounds) {
    switch (number % (with_compounds ? 6 : 5)) {
        case 0:
            return Box{1, 1};
        case 1:
            return Disc{0.5};
        case 2:
            return Capsule{0.6, 0.25};
        case 3:
            return Box{1.3, 0.15};
        case 4:
            return Polygon{.vertices = {{-0.5, -0.4}, {0.5, -0.4}, {0.6, 0.2}, {0, 0.5}, {-0.6, 0.2}}};
        default:
            return Compound{{Piece{.shape = Box{1, 0.3}}, Piece{.shape = Box{0.3, 1}}}};
    }
}

/// A pile between boxes that stand, with a segment that moves just below its floor.
Scene touched_pile(bool with_compounds) {
    Scene scene;
    scene.gravity = {0, -10};
    for (const auto& [shape, position] : {std::pair{Box{kWidth + 4, 2}, Vec2{kWidth / 2, -1}},
                                          {Box{2, 400}, Vec2{-1, 200}},
                                          {Box{2, 400}, Vec2{kWidth + 1, 200}}})
        scene.add({.type = BodyType::static_body, .shape = shape, .position = position, .material = kRough});
    Random random(1);
    for (int i = 0; i < kBodies; ++i)
        scene.add({.shape = shape_of(i, with_compounds),
                   .position = {1 + 1.45 * (i % kColumns), 0.8 + 1.45 * (i / kColumns)},
                   .angle = random.uniform(-0.1, 0.1),
                   .material = kRough});
    return scene;
}

template <class Real>
Touches<Real> touches_of(std::uint64_t seed, bool with_compounds) {
    constexpr std::uint32_t kStanding = 3;  // the first bodies
    return {seed,
            {.make =
                 [with_compounds](Random& random) {
                     return Body{.shape = shape_of(static_cast<int>(random.below(6)), with_compounds),
                                 .angle = random.uniform(-3, 3),
                                 .material = kRough};
                 },
             .may_be_touched = [](std::uint32_t index) { return index >= kStanding; },
             .width = kWidth,
             .low = 40,
             .high = 80,
             .apart = 1.5}};
}

/// Chains and cars on suspensions, of which bodies are removed with their joints among others.
Scene touched_mechanisms() {
    Scene scene = touched_pile(false);
    for (int i = 0; i < 4; ++i)
        add_chain(scene, {.count = 8,
                          .origin = {2.0 + 4 * i, 38},
                          .spacing = 0.6,
                          .pinned = i == 0,
                          .body = {.shape = Capsule{0.5, 0.1}, .material = kRough}});
    for (int i = 0; i < 3; ++i) {
        const BodyId chassis =
            scene.add({.shape = Box{2, 0.5}, .position = {4.0 + 5 * i, 41}, .material = kRough});
        for (const double side : {-0.7, 0.7}) {
            const BodyId wheel =
                scene.add({.shape = Disc{0.35}, .position = {4 + 5 * i + side, 40.6}, .material = kRough});
            scene.add(
                Joint{.a = chassis, .b = wheel, .kind = WheelJoint{.frequency = 4, .damping_ratio = 0.7}});
        }
    }
    return scene;
}

template <class Real>
double lowest(const BasicWorld<Real>& world) {
    double y = 0;
    const auto bodies = world.bodies();
    for (std::size_t i = 0; i < bodies.count; ++i)
        if (bodies.position_y[i] > -0.9) y = std::min(y, static_cast<double>(bodies.position_y[i]));
    return y;
}

}  // namespace

TEST_SUITE("hard cases/touched worlds of shapes") {
    // Each touch had all pairs and contacts found anew: a step of a heap of 2,000 boxes took 2.6 times as
    // long when one body far away was put elsewhere.
    TEST_CASE("B39: what is done to one body far away costs no search for the pairs of the others") {
        for (const Scene& scene : {touched_pile(false), touched_pile(true), touched_mechanisms()}) {
            World world(scene, {.threads = 1});
            for (int i = 0; i < scaled(900, 500); ++i) world.step(kStep);
            const auto rebuilds_of = [&](const auto& touch) {
                const std::int64_t before = world.profile().rebuilds;
                for (int i = 0; i < 60; ++i) {
                    touch(i);
                    world.step(kStep);
                }
                return world.profile().rebuilds - before;
            };
            const BodyId stranger =
                world.add({.shape = Box{1, 1}, .position = {10, 300}, .material = kRough});
            world.step(kStep);
            const auto untouched = rebuilds_of([&](int) {});
            const auto moved = rebuilds_of([&](int i) { world.set_position(stranger, {10.0 + i % 2, 300}); });
            BodyId added = stranger;
            const auto replaced = rebuilds_of([&](int) {
                world.remove(added);
                added = world.add({.shape = Box{1, 1}, .position = {10, 300}, .material = kRough});
            });
            report("steps that found all pairs, of 60: untouched ", untouched, ", one body put elsewhere ",
                   moved, ", removed and added ", replaced);
            CHECK(moved <= untouched + 6);
            CHECK(replaced <= untouched + 6);
        }
    }

    // A pair that was not found would let two bodies through each other.
    TEST_CASE_TEMPLATE("B39: shapes that come, go and are thrown in every step meet all others", Real, float,
                       double) {
        for (const bool with_compounds : {false, true})
            for (std::uint64_t seed = 3; seed <= scaled(4u, 3u); ++seed) {
                CAPTURE(with_compounds);
                CAPTURE(seed);
                BasicWorld<Real> world(touched_pile(with_compounds), {.threads = 1});
                for (int i = 0; i < scaled(400, 200); ++i) world.step(kStep);
                auto touches = touches_of<Real>(seed, with_compounds);
                for (int i = 0; i < scaled(300, 200); ++i) {
                    touches.touch(world);
                    world.step(kStep);
                }
                for (int i = 0; i < scaled(600, 400); ++i) world.step(kStep);
                const double overlap = world.overlaps().max;
                report("shapes that come and go", with_compounds ? ", with compounds" : "", ", seed ", seed,
                       ": overlap in the end ", overlap, " inradii");
                CHECK(overlap < 0.6);  // .05 to .4 of an inradius, of planks at the ends of others
                CHECK(lowest(world) > -0.05);
                CHECK(world.quarantined().empty());
            }
    }

    // Contacts keep their impulses: a heap that lost them would fall by 5 mm in a step, at .17 m/s.
    TEST_CASE_TEMPLATE("B39: a heap of shapes does not notice what is done far away from it", Real, float,
                       double) {
        BasicWorld<Real> world(touched_pile(true), {.threads = 1});
        for (int i = 0; i < 900; ++i) world.step(kStep);
        BodyId stranger = world.add({.shape = Box{1, 1}, .position = {10, 300}, .material = kRough});
        const auto fastest = [&] {
            double most = 0;
            const auto bodies = world.bodies();
            for (std::size_t i = 0; i < bodies.count; ++i)
                if (bodies.position_y[i] < 200)
                    most = std::max(most, std::hypot(static_cast<double>(bodies.velocity_x[i]),
                                                     static_cast<double>(bodies.velocity_y[i])));
            return most;
        };
        double before = 0, after = 0;
        for (int i = 0; i < 60; ++i) {
            world.step(kStep);
            before = std::max(before, fastest());
        }
        for (int i = 0; i < 60; ++i) {
            world.remove(stranger);
            stranger = world.add({.shape = Box{1, 1}, .position = {10, 300}, .material = kRough});
            world.step(kStep);
            after = std::max(after, fastest());
        }
        report("fastest body of a heap at rest: ", before, " m/s, with a body that goes and comes far away ",
               after, " m/s");
        CHECK(after < std::max(2 * before, 0.01));
    }

    TEST_CASE_TEMPLATE(
        "B39: a touched world of shapes goes on bit for bit from a state saved among the touches", Real,
        float, double) {
        for (const bool with_compounds : {false, true}) {
            CAPTURE(with_compounds);
            BasicWorld<Real> world(touched_pile(with_compounds), {.threads = 1});
            for (int i = 0; i < 120; ++i) world.step(kStep);
            auto touches = touches_of<Real>(5, with_compounds);
            for (int i = 0; i < 40; ++i) {
                touches.touch(world);
                world.step(kStep);
            }
            touches.touch(world);  // what the next step is yet to follow is in the state
            BasicWorld<Real> other(world);
            Touches<Real> same(touches);
            for (int i = 0; i < 40; ++i) {
                world.step(kStep), other.step(kStep);
                REQUIRE(world.state_hash() == other.state_hash());
                touches.touch(world), same.touch(other);
            }
        }
    }

    TEST_CASE_TEMPLATE("B39: mechanisms in a touched world hold together, and go on from a state saved there",
                       Real, float, double) {
        BasicWorld<Real> world(touched_mechanisms(), {.threads = 1});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        auto touches = touches_of<Real>(7, false);
        for (int i = 0; i < 60; ++i) {
            touches.touch(world);
            world.step(kStep);
        }
        CHECK(world.joint_count() < touched_mechanisms().joints.size());  // some were removed
        CHECK(world.joint_count() > 10);
        touches.touch(world);
        BasicWorld<Real> other(world);
        Touches<Real> same(touches);
        for (int i = 0; i < 30; ++i) {
            world.step(kStep), other.step(kStep);
            REQUIRE(world.state_hash() == other.state_hash());
            touches.touch(world), same.touch(other);
        }
        for (int i = 0; i < 400; ++i) world.step(kStep);
        report("mechanisms in a touched world: joints ", world.joint_count(), ", open by ",
               world.joint_errors().max, " m, overlap ", world.overlaps().max, " inradii");
        CHECK(world.joint_errors().max < 0.02);
        CHECK(world.overlaps().max < 0.6);
        CHECK(world.quarantined().empty());
    }

    TEST_CASE("B39: a touched world of shapes has the same bits for every instruction set and thread count") {
        const Scene scene = touched_pile(true);
        const auto hash_of = [&](const WorldOptions& options) {
            World world(scene, options);
            for (int i = 0; i < 60; ++i) world.step(kStep);
            auto touches = touches_of<float>(6, true);
            for (int i = 0; i < 40; ++i) {
                touches.touch(world);
                world.step(kStep);
            }
            return world.state_hash();
        };
        const std::uint64_t expected = hash_of({.isa = "scalar", .threads = 1});
        for (const std::string& isa : runnable_instruction_sets()) {
            CAPTURE(isa);
            CHECK(hash_of({.isa = isa, .threads = 3}) == expected);
        }
    }
}

}  // namespace test_touched_shapes

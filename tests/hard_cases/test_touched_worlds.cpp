// B39 of docs/hard-cases.md: worlds that are touched in every step.
#include "math/random.hpp"
#include "math/vec2_math.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/touches.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <variant>
#include <vector>

namespace test_touched_worlds {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kWidth = 20;
constexpr int kDiscs = 400, kColumns = 15;
constexpr std::uint32_t kSegment = kDiscs;  // index of its handle

/// Rough discs in a box open at the top, and a segment just below the floor.
Scene touched_pile(double restitution) {
    const Material rough{.friction = 0.5, .restitution = restitution};
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -10};
    scene.walls = Walls{.min = {0, 0}, .max = {kWidth, 400}, .top = false, .material = rough};
    Random random(1);
    for (int i = 0; i < kDiscs; ++i)
        scene.add({.shape = Disc{random.uniform(0.4, 0.6)},
                   .position = {0.65 + 1.25 * (i % kColumns), 0.7 + 1.25 * (i / kColumns)},
                   .material = rough});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-2, 0}, {2, 0}},
               .position = {kWidth / 2, -0.2},
               .material = rough});
    return scene;
}

template <class Real>
Touches<Real> touches_of(std::uint64_t seed) {
    return {seed,
            {.make = [](Random&) { return Body{.shape = Disc{0.5}, .material = {.friction = 0.5}}; },
             .may_be_touched = [](std::uint32_t index) { return index != kSegment; },
             .width = kWidth,
             .low = 30,
             .high = 60,
             .apart = 1.3}};
}

/// Touches bodies, and drives the segment.
template <class Real>
void touch(BasicWorld<Real>& world, Touches<Real>& touches, int step) {
    touches.touch(world);
    world.set_velocity({kSegment, 0}, {0, 0.5 * std::cos(0.05 * step)});
}

}  // namespace

TEST_SUITE("hard cases/touched worlds") {
    // A pair that was not found would let two bodies through each other.
    TEST_CASE_TEMPLATE("B39: bodies that come, go and are thrown in every step meet all others", Real, float,
                       double) {
        for (const double restitution : {0.0, 0.3}) {
            CAPTURE(restitution);
            BasicWorld<Real> world(touched_pile(restitution), {.threads = 1});
            for (int i = 0; i < scaled(600, 300); ++i) world.step(kStep);
            auto touches = touches_of<Real>(3);
            double deepest = 0;
            for (int i = 0; i < scaled(400, 200); ++i) {
                touch(world, touches, i);
                world.step(kStep);
                if (i % 4 == 0) deepest = std::max(deepest, world.overlaps().max);
            }
            report("restitution ", restitution, ": overlap ", deepest);
            CHECK(deepest < 0.1);
            world.set_velocity({kSegment, 0}, {});  // else it goes on into the pile
            for (int i = 0; i < scaled(600, 400); ++i) world.step(kStep);
            CHECK(world.overlaps().max < 0.005);
            CHECK(world.quarantined().empty());
        }
    }

    // What is swept behind impacts, eight times in a substep, is most of the time of a pile that sinks.
    TEST_CASE_TEMPLATE("B39: a pile that sinks as it loses bodies is swept behind few of its impacts", Real,
                       float, double) {
        BasicWorld<Real> world(touched_pile(0.3), {.threads = 1});
        for (int i = 0; i < 600; ++i) world.step(kStep);
        const auto swept = [&] {
            std::int64_t calls = 0;
            for (const StageTime& stage : world.profile().stages)
                if (stage.name == "settle_struck_contacts") calls = stage.calls;
            return calls;
        };
        const std::int64_t before = swept();
        constexpr int kSteps = 100;
        Random random(9);
        for (int i = 0; i < kSteps; ++i) {
            const auto bodies = world.bodies();
            const BodyId gone = bodies.id[random.below(bodies.count)];
            if (gone.index != kSegment) world.remove(gone);
            world.step(kStep);
        }
        const std::int64_t calls = swept() - before, substeps = kSteps * world.plan().substeps;
        report("swept behind the impacts of ", calls, " of ", substeps, " substeps");
        CHECK(calls < substeps / 2);  // 0.7 of them where what is left closing counts from .002 radii on
    }

    TEST_CASE_TEMPLATE("B39: a touched world goes on bit for bit from a state saved among the touches", Real,
                       float, double) {
        const Scene scene = touched_pile(0.3);
        BasicWorld<Real> world(scene, {.threads = 1});
        for (int i = 0; i < 120; ++i) world.step(kStep);
        auto touches = touches_of<Real>(4);
        for (int i = 0; i < 40; ++i) {
            touch(world, touches, i);
            world.step(kStep);
        }
        touch(world, touches, 40);  // what the next step is yet to follow is in the state
        BasicWorld<Real> other(world);
        Touches<Real> same(touches);
        for (int i = 41; i < 80; ++i) {
            world.step(kStep), other.step(kStep);
            REQUIRE(world.state_hash() == other.state_hash());
            touch(world, touches, i), touch(other, same, i);
        }
    }

    TEST_CASE("B39: a sensor in a touched world tells who is in it") {
        constexpr double kReach = 4, kEdge = 1e-3;  // m
        constexpr Vec2 kPlace{10, 12};
        Scene scene = touched_pile(0);
        scene.add({.type = BodyType::static_body, .shape = Disc{kReach}, .position = kPlace, .sensor = true});
        const BodyId sensor{kSegment + 1, 0};
        World world(scene, {.threads = 1});
        for (int i = 0; i < 300; ++i) world.step(kStep);
        Random random(6);
        for (int i = 0; i < 120; ++i) {
            const std::uint32_t index = static_cast<std::uint32_t>(random.below(kDiscs));
            world.set_position({index, 0}, kPlace + Vec2{random.uniform(-9, 9), random.uniform(6, 9)});
            world.step(kStep);
            const std::vector<BodyId> told = world.sensed(sensor);
            for (std::uint32_t body = 0; body < kDiscs; ++body) {
                const Vec2 way = world.state({body, 0}).position - kPlace;
                const double apart =
                    std::hypot(way.x, way.y) - kReach - std::get<Disc>(world.shape({body, 0})).radius;
                if (std::fabs(apart) < kEdge) continue;
                const bool is_told = std::find(told.begin(), told.end(), BodyId{body, 0}) != told.end();
                REQUIRE(is_told == (apart < 0));
            }
        }
    }

    TEST_CASE("B39: one body that goes leaves the others of a pile where they are") {
        BasicWorld<float> start(touched_pile(0), {.threads = 1});
        for (int i = 0; i < 1200; ++i) start.step(kStep);
        double rms = 0;
        constexpr std::uint32_t kTried = 16;
        for (std::uint32_t k = 0; k < kTried; ++k) {
            World world(start);
            world.remove({25 * k, 0});
            world.step(kStep);
            const auto bodies = world.bodies();
            double sum = 0;
            for (std::size_t i = 0; i < bodies.count; ++i) {
                const double x = bodies.velocity_x[i], y = bodies.velocity_y[i];
                sum += x * x + y * y;
            }
            rms = std::max(rms, std::sqrt(sum / static_cast<double>(bodies.count)));
        }
        report("rms after one body went, at most ", rms, " m/s");
        // What gravity makes of a body in a step is 0.17 m/s: on average fewer than one in ten fall.
        CHECK(rms < 0.05);
    }
}

}  // namespace test_touched_worlds

// Hard cases of mechanisms that hang taut: B44 and B45 of docs/hard-cases.md.
#include "support/effort.hpp"
#include "support/report.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include <doctest/doctest.h>
#include <carom/carom.hpp>

namespace test_bridges {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr int kPlanks = 24;
constexpr double kPlank = 0.8;        // m, length of a plank
constexpr double kLargestRise = 0.2;  // J, a thousandth of what the planks' weight does on 1 m
constexpr Material kWood{.friction = 0.5};

/// A bridge of planks, hinged to each other and to a block at either end, along an arc that hangs through.
/// @param slope  rad, at the ends; 0: the planks are in a line, exactly as long as the blocks are apart
Scene bridge(double slope) {
    Scene scene;
    scene.gravity = {0, -10};
    const BodyId left = scene.add(
        {.type = BodyType::static_body, .shape = Box{4, 1}, .position = {-2, 0}, .material = kWood});
    std::vector<BodyId> planks;
    Vec2 end{0, 0.4};
    for (int i = 0; i < kPlanks; ++i) {
        const double angle = slope * (2 * (i + 0.5) / kPlanks - 1);
        const Vec2 along{kPlank * std::cos(angle), kPlank * std::sin(angle)};
        const Vec2 next{end.x + along.x, end.y + along.y};
        planks.push_back(scene.add({.shape = Box{kPlank, 0.2},
                                    .position = {0.5 * (end.x + next.x), 0.5 * (end.y + next.y)},
                                    .angle = angle,
                                    .material = {.density = 5, .friction = 0.5}}));
        const BodyId before = i == 0 ? left : planks[std::size_t(i) - 1];
        scene.add(Joint{.a = before, .b = planks.back(), .kind = RevoluteJoint{.anchor = end}});
        end = next;
    }
    const BodyId right = scene.add(
        {.type = BodyType::static_body, .shape = Box{4, 1}, .position = {end.x + 2, 0}, .material = kWood});
    scene.add(Joint{.a = right, .b = planks.back(), .kind = RevoluteJoint{.anchor = end}});
    return scene;
}

void add_boxes(Scene& scene, int count) {
    for (int i = 0; i < count; ++i)
        scene.add(
            {.shape = Box{0.6, 0.6}, .position = {5 + i % 8 * 0.9, 3 + i / 8 * 0.8}, .material = kWood});
}

/// A ball on a chain of links, let go level; it is hinged by its rim, so that it turns about the last link.
template <class Real>
BasicWorld<Real> wrecking_ball(double mass) {
    constexpr int kLinks = 14;
    constexpr double kLink = 0.7, kRadius = 1.2;
    Scene scene;
    scene.gravity = {0, -10};
    std::optional<BodyId> last;
    for (int i = 0; i < kLinks; ++i) {
        const BodyId link =
            scene.add({.shape = Capsule{0.5, 0.1}, .position = {-kLink * (i + 0.5), 0}, .group = -1});
        scene.add(Joint{.a = last, .b = link, .kind = RevoluteJoint{.anchor = Vec2{-kLink * i, 0}}});
        last = link;
    }
    const BodyId ball = scene.add(
        {.shape = Disc{kRadius}, .position = {-kLink * kLinks - kRadius, 0}, .mass = mass, .group = -1});
    scene.add(Joint{.a = last, .b = ball, .kind = RevoluteJoint{.anchor = Vec2{-kLink * kLinks, 0}}});
    return BasicWorld<Real>(scene);
}

}  // namespace

TEST_SUITE("hard cases: bridges") {
    TEST_CASE_TEMPLATE("B44: a heavy ball on a light chain swings without coming off it", Real, float,
                       double) {
        for (const double mass : {2.0, 20.0, 200.0}) {
            CAPTURE(mass);
            BasicWorld<Real> world = wrecking_ball<Real>(mass);
            const double start = world.ledger().energy.total();
            double gap = 0, rise = 0;
            for (int i = 0; i < scaled(1800, 1200); ++i) {
                world.step(kStep);
                gap = std::max(gap, world.joint_errors().max);
                rise = std::max(rise, world.ledger().energy.total() - start);
            }
            report("B44: ball of ", mass, " kg: gap ", gap, " m, energy up by ", rise, " J of ",
                   mass * 10 * 11, ", at the end by ", world.ledger().energy.total() - start);
            CHECK(gap < 0.02 * 0.7);
            CHECK(rise < 1e-3 * mass * 10 * 11);
        }
    }

    TEST_CASE("B45: bridges that are taut when they are made carry themselves and come to rest") {
        for (const double slope : {0.0, 1e-4, 0.001, 0.01, 0.03, 0.1}) {
            CAPTURE(slope);
            World world(bridge(slope));
            const double start = world.ledger().energy.total();
            double gap = 0, rise = 0;
            for (int i = 0; i < scaled(1200, 600); ++i) {
                world.step(kStep);
                gap = std::max(gap, world.joint_errors().max);
                rise = std::max(rise, world.ledger().energy.total() - start);
            }
            const double speed = std::sqrt(2 * world.ledger().energy.kinetic / (kPlanks * kPlank));
            report("B45: slope ", slope, ": gap ", gap, " m, energy up by ", rise,
                   " J, rms speed at the end ", speed, " m/s");
            CHECK(gap < 0.01 * kPlank);
            CHECK(rise < kLargestRise);
            CHECK(speed < 0.1);
        }
    }

    TEST_CASE("B45: they carry forty boxes that fall on them") {
        const auto slopes = scaled<std::vector<double>>({0, 0.001, 0.01, 0.03, 0.1, 0.3}, {0, 0.01, 0.3});
        for (const double slope : slopes) {
            CAPTURE(slope);
            Scene scene = bridge(slope);
            add_boxes(scene, 40);
            World world(scene);
            const double start = world.ledger().energy.total();
            double gap = 0, overlap = 0, rise = 0;
            for (int i = 0; i < scaled(900, 400); ++i) {
                world.step(kStep);
                gap = std::max(gap, world.joint_errors().max);
                if (i % 5 == 0) overlap = std::max(overlap, world.overlaps().max);
                rise = std::max(rise, world.ledger().energy.total() - start);
            }
            report("B45: slope ", slope, ", 40 boxes: gap ", gap, " m, ", world.joint_errors().max,
                   " at the end, overlap ", overlap, " of a plank's inradius, energy up by ", rise, " J");
            CHECK(gap < 0.03 * kPlank);
            CHECK(world.joint_errors().max < 0.015 * kPlank);
            CHECK(overlap < 0.5);
            CHECK(rise < kLargestRise);
        }
    }
}

}  // namespace test_bridges

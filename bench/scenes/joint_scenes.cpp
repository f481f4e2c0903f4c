#include "scenes/joint_scenes.hpp"

#include <carom/generators.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace carom::bench {
namespace {

constexpr double kGravity = 10;    // m/s²
constexpr double kFriction = 0.5;  // no unit

/// A limb as it hangs down from its hinge on another one, in metres from the hips.
struct Limb {
    int on;               // number of the other one; below zero: none
    Vec2 hinge;           // m
    double length;        // m, between the centres of the capsule's ends
    double radius;        // m
    double lower, upper;  // rad
};

/// Chest, then upwards and outwards; arms and legs hang down.
constexpr std::array<Limb, 11> kLimbs{{
    {-1, {0, 0}, 0.15, 0.11, 0, 0},          // hips
    {0, {0, 0.12}, -0.30, 0.12, -0.5, 0.5},  // chest
    {1, {0, 0.52}, -0.08, 0.10, -0.4, 0.4},  // head
    {1, {0, 0.40}, 0.24, 0.05, -2.5, 2.5},   // upper arms
    {1, {0, 0.40}, 0.24, 0.05, -2.5, 2.5},
    {3, {0, 0.12}, 0.24, 0.04, 0, 2.4},  // forearms
    {4, {0, 0.12}, 0.24, 0.04, 0, 2.4},
    {0, {0, -0.10}, 0.36, 0.07, -0.6, 1.6},  // thighs
    {0, {0, -0.10}, 0.36, 0.07, -0.6, 1.6},
    {7, {0, -0.52}, 0.36, 0.05, -2.3, 0},  // shins
    {8, {0, -0.52}, 0.36, 0.05, -2.3, 0},
}};
constexpr double kTall = 1.9, kWide = 0.6;  // m, of the box that each is given at the start
constexpr double kMeanArea = 0.62;          // m² of the heap that a ragdoll fills, about

void add_ragdoll(Scene& scene, Vec2 hips, std::int32_t group) {
    std::array<BodyId, kLimbs.size()> ids;
    for (std::size_t i = 0; i < kLimbs.size(); ++i) {
        const Limb& limb = kLimbs[i];
        Body body;
        body.shape = Capsule{.length = std::fabs(limb.length), .radius = limb.radius};
        const Vec2 hinge{hips.x + limb.hinge.x, hips.y + limb.hinge.y};
        body.position = {hinge.x, hinge.y - (i == 0 ? 0 : limb.length / 2)};
        body.angle = -std::numbers::pi / 2;
        body.material.friction = kFriction;
        body.group = group;
        ids[i] = scene.add(body);
        if (limb.on < 0) continue;
        scene.add(Joint{.a = ids[static_cast<std::size_t>(limb.on)],
                        .b = ids[i],
                        .kind = RevoluteJoint{.anchor = hinge, .lower = limb.lower, .upper = limb.upper}});
    }
}

}  // namespace

BenchScene net(std::int64_t bodies) {
    constexpr double kSpacing = 0.5, kRadius = 0.1;  // m
    Net net;
    net.count_x = net.count_y =
        std::max<std::int64_t>(2, static_cast<std::int64_t>(std::sqrt(static_cast<double>(bodies)) + 1e-9));
    net.spacing = {kSpacing, kSpacing};
    net.body.shape = Disc{kRadius};
    net.body.mass = 1;
    Scene scene;
    scene.gravity = {0, -kGravity};
    add_net(scene, net);
    constexpr int kLong = 600;  // steps
    return {"net", std::move(scene), {}, 0, kLong};
}

BenchScene ragdolls(std::int64_t bodies) {
    const std::int64_t count = std::max<std::int64_t>(1, bodies / static_cast<std::int64_t>(kLimbs.size()));
    Scene scene;
    scene.gravity = {0, -kGravity};
    const auto across =
        std::max<std::int64_t>(2, std::lround(std::sqrt(kMeanArea * static_cast<double>(count)) / kWide));
    scene.walls.emplace();
    scene.walls->max = {kWide * static_cast<double>(across), 1e4};
    scene.walls->top = false;
    scene.walls->material.friction = kFriction;
    for (std::int64_t i = 0; i < count; ++i) {
        const std::int64_t row = i / across, column = i % across;
        // Odd rows are shifted a little, so that no limb falls upright on another.
        const double x = kWide * (static_cast<double>(column) + (row % 2 == 0 ? 0.45 : 0.55));
        add_ragdoll(scene, {x, 1.1 + kTall * static_cast<double>(row)}, -1 - static_cast<std::int32_t>(i));
    }
    constexpr int kSettle = 900;  // steps
    return {"ragdolls", std::move(scene), {}, kSettle};
}

}  // namespace carom::bench

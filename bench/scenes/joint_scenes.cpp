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
constexpr int kLong = 600;                  // steps, over and over
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

BenchScene car(std::int64_t bodies) {
    constexpr double kHalfLength = 100, kEdge = 0.5;  // m
    constexpr int kOfCar = 3;
    const auto height = [](double x) { return 2 * std::sin(0.16 * x) + 0.25 * std::sin(1.4 * x); };
    Scene scene;
    scene.gravity = {0, -kGravity};
    Chain track;
    // A wall at both ends, and an edge beyond it: the last ones are none in Box2D.
    track.points.push_back({kHalfLength + 20, 20}), track.points.push_back({kHalfLength, 20});
    for (double x = kHalfLength; x >= -kHalfLength; x -= kEdge) track.points.push_back({x, height(x)});
    track.points.push_back({-kHalfLength, 20}), track.points.push_back({-kHalfLength - 20, 20});
    scene.add({.type = BodyType::static_body, .shape = track, .material = {.friction = 0.9}});
    const Vec2 start{-0.9 * kHalfLength, height(-0.9 * kHalfLength) + 1.5};
    const BodyId hull = scene.add({.shape = Box{3, 0.8}, .position = start, .material = {.friction = 0.4}});
    for (const double side : {-1, 1}) {
        const Vec2 axle{start.x + 1.1 * side, start.y - 0.8};
        const BodyId wheel = scene.add({.shape = Disc{0.5}, .position = axle, .material = {.friction = 1.2}});
        scene.add(Joint{.a = hull,
                        .b = wheel,
                        .kind = RevoluteJoint{.anchor = axle, .motor_speed = -12, .max_motor_torque = 8}});
    }
    const std::int64_t crates = std::max<std::int64_t>(0, bodies - 1 - kOfCar);
    for (std::int64_t i = 0; i < crates; ++i) {
        const double x =
            0.9 * kHalfLength * (2 * (static_cast<double>(i) + 0.5) / static_cast<double>(crates) - 1);
        scene.add(
            {.shape = Box{0.6, 0.6}, .position = {x, height(x) + 3}, .material = {.friction = kFriction}});
    }
    return {"car", std::move(scene), {}, 0, kLong};
}

BenchScene chain(std::int64_t bodies) {
    constexpr int kLinks = 20;
    constexpr double kSpacing = 0.6;  // m, of hinges
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls.emplace();
    scene.walls->min = {-20, 0}, scene.walls->max = {20, 60};
    scene.walls->top = false;
    scene.walls->material.friction = kFriction;
    const double left = -kSpacing * kLinks / 2;
    const std::int64_t links = std::min<std::int64_t>(bodies, kLinks);
    for (std::int64_t i = 0; i < links; ++i) {
        const double x = left + kSpacing * (static_cast<double>(i) + 0.5);
        const BodyId link =
            scene.add({.shape = Capsule{0.5, 0.08}, .position = {x, 4}, .material = {.friction = kFriction}});
        if (i == 0) continue;
        scene.add(Joint{.a = BodyId{link.index - 1, 0},
                        .b = link,
                        .kind = RevoluteJoint{.anchor = Vec2{x - kSpacing / 2, 4}}});
    }
    const std::array<Shape, 4> shapes{Box{0.7, 0.5}, Capsule{0.5, 0.2}, Disc{0.35}, Box{0.6, 0.6}};
    for (std::int64_t i = 0; i < bodies - links; ++i) {
        constexpr std::int64_t kInRow = 24;
        const auto column = static_cast<double>(i % kInRow), row = static_cast<double>(i / kInRow);
        scene.add({.shape = shapes[static_cast<std::size_t>(i) % shapes.size()],
                   .position = {-15 + 1.3 * column + 0.4 * row, 7 + 2 * row},
                   .angle = 0.7 * static_cast<double>(i),
                   .material = {.friction = kFriction}});
    }
    return {"chain", std::move(scene), {}, 0, kLong};
}

BenchScene stairs(std::int64_t bodies) {
    constexpr int kSteps = 20;
    constexpr double kTread = 2, kRise = 1;  // m
    Scene scene;
    scene.gravity = {0, -kGravity};
    Chain stairs;
    // As the track's ends.
    stairs.points.push_back({kTread * kSteps + 50, 0}), stairs.points.push_back({kTread * kSteps + 30, 0});
    stairs.points.push_back({kTread * kSteps + 30, -kRise * kSteps});
    for (int i = kSteps; i > 0; --i) {
        stairs.points.push_back({kTread * i, -kRise * i});
        stairs.points.push_back({kTread * i, -kRise * (i - 1)});
    }
    stairs.points.push_back({0, 0});
    stairs.points.push_back({0, 20}), stairs.points.push_back({-20, 20});
    scene.add({.type = BodyType::static_body, .shape = stairs, .material = {.friction = kFriction}});
    add_ragdoll(scene, {1.5, 3}, -1);
    const std::int64_t loose =
        std::max<std::int64_t>(0, bodies - 1 - static_cast<std::int64_t>(kLimbs.size()));
    const std::array<Shape, 4> shapes{Box{0.6, 0.4}, Capsule{0.4, 0.15}, Disc{0.3}, Box{0.5, 0.5}};
    for (std::int64_t i = 0; i < loose; ++i) {
        const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(loose);
        scene.add({.shape = shapes[static_cast<std::size_t>(i) % shapes.size()],
                   .position = {4 + share * (kTread * kSteps - 4), 2 - share * kRise * kSteps},
                   .angle = 0.7 * static_cast<double>(i),
                   .material = {.friction = kFriction}});
    }
    return {"stairs", std::move(scene), {}, 0, kLong};
}

}  // namespace carom::bench

// What is squeezed between bodies that nothing moves, or hardly anything: B30 and B37.
#include <cmath>
#include <numbers>

#include "measure/text.hpp"
#include "torture/hard/box_scenes.hpp"
#include "torture/hard/hard_case.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kPlateSpeed = 0.6, kTilt = 0.02;  // m/s, rad

struct Squeeze {
    int bodies;
    double friction, turning;  // turning: of the plate [rad/s]
    std::uint64_t seed;
};

/// Boxes and triangles on a floor, and a plate, hardly tilted, that comes down on them.
Scene scene_of(const Squeeze& squeeze) {
    Random random(squeeze.seed, 37);
    Scene scene;
    scene.gravity = {0, -10};
    const Material material{.friction = squeeze.friction};
    scene.add(
        {.type = BodyType::static_body, .shape = Box{40, 1}, .position = {0, -0.5}, .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Box{40, 1},
               .position = {0, 3},
               .angle = kTilt,
               .velocity = {0, -kPlateSpeed},
               .angular_velocity = squeeze.turning,
               .material = material});
    for (int i = 0; i < squeeze.bodies; ++i) {
        Body body{.shape = Polygon{{{-0.4, -0.3}, {0.4, -0.3}, {0, 0.5}}}, .material = material};
        if (i % 2 == 1) {
            const double width = random.uniform(0.4, 0.8);
            body.shape = Box{width, random.uniform(0.4, 0.8)};
        }
        body.position.x = random.uniform(-2, 2), body.position.y = random.uniform(0.5, 2);
        body.angle = random.uniform(0, 6), body.mass = random.uniform(1, 10);
        scene.add(body);
    }
    return scene;
}

/// The plate comes down for five seconds and goes up for one.
Measures speed_under_plate(HardRun& run) {
    constexpr double kLargest = 3;                       // asked: 1.5
    const double wedge = kPlateSpeed / std::tan(kTilt);  // m/s: what is smooth slides out so fast
    Largest most;
    for (int i = 0; i < 360; ++i) {
        if (i == 300) run.set_velocity(1, {0, kPlateSpeed});
        if (!run.step()) break;
        for (std::size_t body = 2; body < run.count(); ++body) most.take(run.speed(body));
    }
    return {{"speed/wedge", most.value() / wedge, kLargest},
            {"quarantined", static_cast<double>(run.quarantined()), 0},
            {"m/s", most.value()}};
}

constexpr double kRoomWidth = 8, kRoomHeight = 4;  // m

/// A closed room full of shapes, on whose floor and walls a kinematic disc and box press as they leave it.
Scene room_that_is_left() {
    constexpr int kBodies = 40;
    Random random(37, 0);
    Scene scene;
    scene.gravity = {0, -10};
    const Material material{.friction = 0.5};
    scene.add(
        {.type = BodyType::static_body,
         .shape = Chain{.points = {{0, 0}, {kRoomWidth, 0}, {kRoomWidth, kRoomHeight}, {0, kRoomHeight}},
                        .loop = true},
         .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Disc{1},
               .position = {3, 3},
               .velocity = {0, -0.5},
               .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Box{1.5, 2},
               .position = {5, 2},
               .velocity = {0.5, -0.2},
               .angular_velocity = 0.3,
               .material = material});
    for (int i = 0; i < kBodies; ++i) {
        Shape shape = Box{random.uniform(0.2, 0.8), 0.3};
        if (i % 3 == 1) shape = Capsule{0.4, 0.1};
        if (i % 3 == 2) shape = Polygon{{{-0.3, -0.2}, {0.3, -0.2}, {0, 0.4}}};
        const double x = random.uniform(0.6, kRoomWidth - 0.6), y = random.uniform(0.6, kRoomHeight - 0.6);
        scene.add({.shape = shape, .position = {x, y}, .angle = random.uniform(0, 6), .material = material});
    }
    return scene;
}

/// Slow and fast kinematic bodies and lines press discs, or shapes, against the segments of a room, and into
/// the wedges between these and a static line, as they leave it.
Scene room_that_many_leave(bool of_discs, std::uint64_t seed) {
    constexpr int kBodies = 40, kPushers = 8;
    Random random(37, seed);
    Scene scene;
    const Material material{.friction = 0.5};
    const Vec2 corners[] = {{0, 0}, {kRoomWidth, 0}, {kRoomWidth, kRoomHeight}, {0, kRoomHeight}};
    const auto add_line = [&](Vec2 a, Vec2 b) {
        scene.add({.type = BodyType::static_body, .shape = Segment{a, b}, .material = material});
    };
    for (int i = 0; i < 4; ++i) add_line(corners[i], corners[(i + 1) % 4]);
    add_line({0.1, 1}, {2, 0.1});
    const auto put = [&](Body body, double margin) {
        body.position.x = random.uniform(margin, kRoomWidth - margin);
        body.position.y = random.uniform(margin, kRoomHeight - margin);
        body.angle = random.uniform(0, 6), body.material = material;
        scene.add(body);
    };
    for (int i = 0; i < kPushers; ++i) {
        Body body{.type = BodyType::kinematic_body, .shape = Segment{{-0.6, 0}, {0.6, 0}}};
        if (i % 4 == 1) body.shape = Disc{0.4};
        if (i % 4 == 2 && !of_discs) body.shape = Box{1, 0.5};
        const double angle = random.uniform(0, 6), speed = random.log_uniform(0.05, 20);
        body.velocity = {speed * std::cos(angle), speed * std::sin(angle)};
        body.angular_velocity = random.uniform(-1, 1);
        put(body, 0.8);
    }
    for (int i = 0; i < kBodies; ++i) {
        Body body{.shape = Disc{random.log_uniform(0.03, 0.2)}};
        if (!of_discs && i % 3 == 1) body.shape = Capsule{0.3, 0.1};
        if (!of_discs && i % 3 == 2) body.shape = Box{random.uniform(0.1, 0.5), 0.2};
        put(body, 0.4);
    }
    return scene;
}

Measures left_the_room(HardRun& run) {
    int outside = 0;
    for (int i = 0; i < 900 && run.step(); ++i)
        for (std::size_t body = 0; body < run.count(); ++body) {
            const Vec2 p = run.place(body);
            const bool is_inside = p.x > 0 && p.x < kRoomWidth && p.y > 0 && p.y < kRoomHeight;
            outside += is_inside || !run.is_dynamic(body) ? 0 : 1;
        }
    return {{"times outside", static_cast<double>(outside), 0},
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

/// Discs that fall into a box of edges in which a paddle turns. Its blades reach through the floor, so that
/// it presses discs out of corners that close.
Scene paddle_in_a_box(double mass_ratio, double friction, std::uint64_t seed) {
    constexpr int kDiscs = 200, kInARow = 11;
    constexpr double kHalfWidth = 5, kHeight = 40, kPitch = 0.85, kLowest = 5;  // m
    constexpr double kReach = 3, kAxle = 2, kTurning = 6;                       // m, m, rad/s
    Random random(seed, 37);
    Scene scene;
    scene.gravity = {0, -10};
    scene.effects.ledger = true;
    const Material material{.friction = friction};
    scene.add({.type = BodyType::static_body,
               .shape = Chain{.points = {{-kHalfWidth, kHeight},
                                         {-kHalfWidth, 0},
                                         {kHalfWidth, 0},
                                         {kHalfWidth, kHeight}}},
               .material = material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Segment{{-kReach, 0}, {kReach, 0}},
               .position = {0, kAxle},
               .angular_velocity = kTurning,
               .material = material});
    for (int i = 0; i < kDiscs; ++i) {
        const double radius = random.uniform(0.2, 0.4);
        scene.add({.shape = Disc{radius},
                   .position = {-4.3 + kPitch * (i % kInARow) + random.uniform(0, 0.02),
                                kLowest + kPitch * (i / kInARow)},
                   .mass = radius * radius * random.log_uniform(1, mass_ratio),
                   .material = material});
    }
    return scene;
}

/// What the discs get in one step and the paddle does not give.
Measures energy_from_a_paddle(HardRun& run) {
    constexpr double kMost = 0.01;  // contacts may give 3 thousandths of a disc's energy in a substep
    const double start = run.energy();
    Largest gain;
    for (int i = 0; i < 480; ++i) {
        const double before = run.energy() - run.driven();
        if (!run.step()) break;
        gain.take((run.energy() - run.driven() - before) / start);
    }
    return {{"gain in a step", gain.value(), kMost},
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

constexpr double kArm = 2.5, kStirring = 2;  // m, rad/s: of the cross below

/// Boxes, or discs, boxes and capsules, that fall on a kinematic cross which turns in a box. What lies under
/// its arms has nowhere to go.
/// @param gap  m, between its arms and the floor; bodies are .4 to .7 m thick
Scene cross_in_a_box(double gap, double friction, bool are_mixed, std::uint64_t seed) {
    constexpr int kBodies = 120, kInARow = 10;
    constexpr double kHalfWidth = 4, kHeight = 16, kPitch = 0.75, kLowest = 6.2, kThickness = 0.3;  // m
    Random random(seed, 37);
    Scene scene;
    scene.gravity = {0, -10};
    const Material material{.friction = friction};
    scene.walls = Walls{.min = {-kHalfWidth, 0}, .max = {kHalfWidth, kHeight}, .material = material};
    scene.add({.type = BodyType::kinematic_body,
               .shape = Compound{{{.shape = Box{2 * kArm, kThickness}, .material = material},
                                  {.shape = Box{kThickness, 2 * kArm}, .material = material}}},
               .position = {0, kArm + gap},
               .angular_velocity = kStirring,
               .material = material});
    for (int i = 0; i < kBodies; ++i) {
        const double width = random.uniform(0.4, 0.7), height = random.uniform(0.4, 0.7);
        Body body{.shape = Box{width, height}, .material = material};
        if (are_mixed && i % 3 == 0) body.shape = Disc{width / 2};
        if (are_mixed && i % 3 == 2) body.shape = Capsule{0.6 * width, 0.3 * height};
        body.position = {-3.4 + kPitch * (i % kInARow), kLowest + kPitch * (i / kInARow)};
        body.angle = random.uniform(0, 6);
        scene.add(body);
    }
    return scene;
}

/// Bodies fall as fast as three times the ends of the arms.
Measures speed_beside_a_cross(HardRun& run) {
    constexpr double kLargest = 12;
    Largest most;
    for (int i = 0; i < 720 && run.step(); ++i)
        for (std::size_t body = 1; body < run.count(); ++body) most.take(run.speed(body));
    return {{"speed/arm's", most.value() / (kStirring * kArm), kLargest},
            {"quarantined", static_cast<double>(run.quarantined()), 0},
            {"m/s", most.value()}};
}

}  // namespace

HardCases shapes_that_a_cross_stirs(Extent extent) {
    HardCases all;
    for (const bool are_mixed : {false, true})
        for (const double friction : {0.0, 0.5}) {
            std::vector<Scene> scenes;
            for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(3, 1); ++seed)
                for (const double gap : {0.2, 0.8})
                    if (!extent.is_short || (gap == 0.2) == are_mixed)
                        scenes.push_back(cross_in_a_box(gap, friction, are_mixed, seed));
            all.push_back(
                {.code = "B37",
                 .name = format("120 %s that a cross stirs, friction %g",
                                are_mixed ? "discs, boxes and capsules" : "boxes", friction),
                 .make = [first = scenes.front()] { return first; },
                 .run = [more = std::vector(scenes.begin() + 1, scenes.end())](
                            HardRun& run) { return worst_of_all(run, more, speed_beside_a_cross); }});
        }
    return all;
}

HardCases discs_that_a_paddle_stirs(Extent extent) {
    HardCases all;
    for (const double mass_ratio : {1.0, 30.0})
        for (const double friction : {0.0, 0.3}) {
            std::vector<Scene> scenes;
            for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(2, 1); ++seed)
                scenes.push_back(paddle_in_a_box(mass_ratio, friction, seed));
            all.push_back(
                {.code = "B37",
                 .name = format("discs that a paddle stirs, masses 1:%g, friction %g", mass_ratio, friction),
                 .make = [first = scenes.front()] { return first; },
                 .run = [more = std::vector(scenes.begin() + 1, scenes.end())](
                            HardRun& run) { return worst_of_all(run, more, energy_from_a_paddle); }});
        }
    return all;
}

HardCases shapes_under_a_plate(Extent extent) {
    HardCases all;
    for (const double friction : {0.5, 5.0})
        for (const double turning : {0.0, 0.02})
            for (const int bodies : {1, 3, 10}) {
                std::vector<Scene> scenes;
                for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(6, 1); ++seed)
                    scenes.push_back(scene_of({bodies, friction, turning, seed}));
                all.push_back(
                    {.code = "B37",
                     .name = format("shapes under a plate: %d, friction %g, turning %g rad/s", bodies,
                                    friction, turning),
                     .make = [first = scenes.front()] { return first; },
                     .run = [more = std::vector(scenes.begin() + 1, scenes.end())](
                                HardRun& run) { return worst_of_all(run, more, speed_under_plate); }});
            }
    return all;
}

HardCases shapes_in_a_room_that_is_left(Extent) {
    return {{.code = "B37",
             .name = "40 shapes in a room that a disc and a box leave",
             .make = room_that_is_left,
             .run = left_the_room}};
}

HardCases rooms_that_many_leave(Extent extent) {
    HardCases all;
    for (const bool of_discs : {false, true}) {
        std::vector<Scene> scenes;
        for (std::uint64_t seed = 1; seed <= extent.of<std::uint64_t>(30, 3); ++seed)
            scenes.push_back(room_that_many_leave(of_discs, seed));
        all.push_back({.code = "B37",
                       .name = of_discs ? "40 discs in rooms that discs and lines leave"
                                        : "40 shapes in rooms that discs, boxes and lines leave",
                       .make = [first = scenes.front()] { return first; },
                       .run = [more = std::vector(scenes.begin() + 1, scenes.end())](
                                  HardRun& run) { return worst_of_all(run, more, left_the_room); }});
    }
    return all;
}

HardCases discs_between_a_box_and_a_post(Extent) {
    constexpr double kSpeed = 8, kPost = 5;  // m/s, m: the post's face
    return {{.code = "B30",
             .name = "a disc between a box of 1,000 kg and a post",
             .make =
                 [] {
                     const Material material{.friction = 0.5};
                     Scene scene = box_ground(material.friction);
                     scene.add({.type = BodyType::static_body,
                                .shape = Box{1, 4},
                                .position = {kPost + 0.5, 2},
                                .material = material});
                     scene.add({.shape = Disc{0.25}, .position = {4.7, 0.25}, .material = material});
                     Body heavy = box_at(2, 1, 2, 2, material.friction);
                     heavy.mass = 1000, heavy.velocity = {kSpeed, 0};
                     scene.add(heavy);
                     return scene;
                 },
             .run = [](HardRun& run) -> Measures {
                 Largest fastest;
                 for (int i = 0; i < 600 && run.step(); ++i) fastest.take(run.speed(2));
                 const double own = std::sqrt(kSpeed * kSpeed + 2 * kBoxGravity * 1);
                 return {{"speed/box's", fastest.value() / own, 1.05},
                         {"m beyond the box", run.place(3).x - run.place(2).x, 0},
                         {"m beyond the post", run.place(2).x - kPost, 0}};
             }}};
}

}  // namespace carom::torture

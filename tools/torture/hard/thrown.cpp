// Bodies that are thrown, within a step, at what they had no contact with: B43.
#include <array>
#include <cmath>
#include <numbers>

#include "measure/text.hpp"
#include "torture/hard/hard_case.hpp"
#include "torture/random.hpp"

namespace carom::torture {
namespace {

using measure::format;

constexpr double kHalfPlate = 8, kThickness = 0.2;  // m
constexpr double kApart = 200;                      // m, from one shot to the next

Vec2 turned(double angle, Vec2 p) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
}

Vec2 seen_from(const BodyState& frame, Vec2 p) {
    return turned(-frame.angle, {p.x - frame.position.x, p.y - frame.position.y});
}

/// Bodies of about a metre.
Shape random_shape(Random& random) {
    switch (random.below(5)) {
        case 0:
            return Disc{0.4};
        case 1:
            return Box{1, random.uniform(0.2, 1)};
        case 2:
            return Capsule{0.8, random.uniform(0.1, 0.3)};
        case 3:
            return Polygon{{{-0.5, -0.3}, {0.5, -0.3}, {0, 0.6}}};
        default:
            return Compound{{{.shape = Box{1, 0.3}}, {.shape = Disc{0.3}, .position = {0.5, 0}}}};
    }
}

/// Something long and thin along x that nothing moves.
Shape random_plate(Random& random) {
    switch (random.below(4)) {
        case 0:
            return Box{2 * kHalfPlate, kThickness};
        case 1:
            return Capsule{2 * kHalfPlate, 0.5 * kThickness};
        case 2:
            return Segment{{-kHalfPlate, 0}, {kHalfPlate, 0}};
        default:
            return Compound{{{.shape = Box{kHalfPlate, kThickness}, .position = {-0.5 * kHalfPlate, 0}},
                             {.shape = Box{kHalfPlate, kThickness}, .position = {0.5 * kHalfPlate, 0}}}};
    }
}

/// A plate, a light body before it, and one of a thousand times its mass that flies at that, towards the
/// plate, at 100 to 300 m/s: within one step the light one is hit and far behind the plate.
void add_shot(Scene& scene, Vec2 at, Random& random) {
    Material material;
    material.friction = random.uniform(), material.restitution = random.uniform();
    Body plate{.type = BodyType::static_body, .shape = random_plate(random), .position = at};
    plate.angle = random.uniform(0, 2 * std::numbers::pi);
    plate.material = material;
    if (random.chance(0.5)) {
        plate.type = BodyType::kinematic_body;
        plate.velocity.x = random.uniform(-10, 10), plate.velocity.y = random.uniform(-10, 10);
        plate.angular_velocity = random.uniform(-2, 2);
    }
    Vec2 light;
    light.x = random.uniform(-2, 2), light.y = random.uniform(0.8, 2);
    const double steepness = random.uniform(0.6, 1) * 0.5 * std::numbers::pi;
    const double away = random.uniform(1.5, 4), speed = random.uniform(100, 300);
    const Vec2 way{std::cos(steepness), -std::sin(steepness)};
    const double beside = random.uniform(-0.2, 0.2);
    const auto body = [&](Vec2 p, double mass) {
        const Vec2 from = turned(plate.angle, p);
        Body made{.shape = random_shape(random), .position = {at.x + from.x, at.y + from.y}};
        made.angle = random.uniform(0, 2 * std::numbers::pi);
        made.mass = mass, made.material = material;
        return made;
    };
    scene.add(plate);
    scene.add(body(light, 1));
    Body heavy = body({light.x - away * way.x + beside, light.y - away * way.y}, 1000);
    heavy.velocity = turned(plate.angle, {speed * way.x, speed * way.y});
    scene.add(heavy);
}

constexpr std::size_t kBodiesAShot = 3;

Scene shots(int count) {
    Random random(43, 0);
    Scene scene;
    const int side = static_cast<int>(std::ceil(std::sqrt(count)));
    for (int i = 0; i < count; ++i)
        add_shot(scene, {kApart * (i % side - 0.5 * side), kApart * (i / side - 0.5 * side)}, random);
    return scene;
}

/// Bodies that got from one side of their plate to the other through it.
Measures passed_plates(HardRun& run) {
    int count = 0;
    std::vector<bool> has_passed(run.count());
    std::vector<Vec2> before(run.count());
    for (int step = 0; step < 20; ++step) {
        for (std::size_t i = 0; i < run.count(); ++i) {
            if (i % kBodiesAShot == 0) continue;
            const Vec2 now = seen_from(run.state(i - i % kBodiesAShot), run.place(i));
            const Vec2 then = before[i];
            before[i] = now;
            if (step == 0 || has_passed[i] || !(then.y > 0 && now.y < 0)) continue;
            const double share = then.y / (then.y - now.y), place = then.x + share * (now.x - then.x);
            if (std::fabs(place) < kHalfPlate - 0.5) has_passed[i] = true, ++count;
        }
        if (!run.step()) break;
    }
    return {{"passed", static_cast<double>(count), 0},
            {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

constexpr int kSides = 6;
constexpr double kDrum = 20;  // m, to the corners

Scene drum() {
    constexpr int kBodies = 40;
    const Material material{.friction = 0.2, .restitution = 1};
    Random random(4, 43);
    Scene scene;
    Chain loop{.points = {}, .loop = true};
    for (int i = 0; i < kSides; ++i)
        loop.points.push_back(turned(2 * std::numbers::pi * i / kSides, {kDrum, 0}));
    scene.add(
        {.type = BodyType::kinematic_body, .shape = loop, .angular_velocity = -3, .material = material});
    for (int i = 0; i < kBodies; ++i) {
        Body body{.shape = random_shape(random), .material = material};
        body.position.x = random.uniform(-10, 10), body.position.y = random.uniform(-10, 10);
        body.angle = random.uniform(0, 6);
        body.velocity.x = random.uniform(-300, 300), body.velocity.y = random.uniform(-300, 300);
        scene.add(body);
    }
    return scene;
}

bool is_in_drum(const HardRun& run, std::size_t body) {
    const double inner = kDrum * std::cos(std::numbers::pi / kSides);
    const Vec2 p = seen_from(run.state(0), run.place(body));
    Largest most;
    for (int k = 0; k < kSides; ++k) {
        const Vec2 n = turned(2 * std::numbers::pi * (k + 0.5) / kSides, {1, 0});
        most.take(n.x * p.x + n.y * p.y);
    }
    return most.value() <= inner;
}

/// A triangle whose sides are 22 m from its axis and come 33 mm nearer to what lies on them in each step than
/// a straight way takes them.
Scene fast_drum(bool of_discs) {
    constexpr int kBodies = 4;
    constexpr double kCorner = 44;  // m, from the axis
    const Material material{.friction = 1};
    Random random(5, 43);
    Scene scene;
    scene.gravity = {0, -9.81};
    Chain loop{.points = {}, .loop = true};
    for (int i = 0; i < 3; ++i) loop.points.push_back(turned(2 * std::numbers::pi * i / 3, {kCorner, 0}));
    scene.add(
        {.type = BodyType::kinematic_body, .shape = loop, .angular_velocity = -2.5, .material = material});
    for (int i = 0; i < kBodies; ++i) {
        Body body{.shape = Disc{0.1}, .material = material};
        if (!of_discs) body.shape = Box{0.1, random.uniform(0.1, 0.3)};
        // One after the other: which argument of a call is drawn first is the compiler's choice.
        const double angle = random.uniform(0, 6), distance = random.uniform(5, 20);
        body.position = turned(angle, {distance, 0});
        body.velocity = turned(random.uniform(0, 6), {10, 0});
        scene.add(body);
    }
    return scene;
}

Measures ride_in_a_fast_drum(HardRun& run, Extent extent) {
    constexpr double kStep = 0.022;  // s
    const int steps = extent.of(600, 300), from = 200;
    Largest overlap;
    for (int i = 0; i < steps && run.step(kStep); ++i)
        if (i >= from) overlap.take(run.overlap());
    return {{"overlap", overlap.value(), 0.1}, {"quarantined", static_cast<double>(run.quarantined()), 0}};
}

}  // namespace

HardCases shots_at_plates(Extent extent) {
    const int count = extent.of(1000, 200);
    return {{.code = "B43",
             .name = format("%d shots of shapes at plates", count),
             .make = [=] { return shots(count); },
             .run = passed_plates}};
}

HardCases shapes_in_a_drum(Extent extent) {
    return {{.code = "B43",
             .name = "40 shapes in a drum that throws them",
             .make = drum,
             .run = [=](HardRun& run) -> Measures {
                 int outside = 0;
                 for (int i = 0; i < extent.of(600, 120) && run.step(); ++i)
                     for (std::size_t body = 1; body < run.count(); ++body)
                         outside += is_in_drum(run, body) ? 0 : 1;
                 return {{"times outside", static_cast<double>(outside), 0},
                         {"quarantined", static_cast<double>(run.quarantined()), 0}};
             }}};
}

HardCases bodies_in_a_fast_drum(Extent extent) {
    HardCases cases;
    for (const bool of_discs : {false, true})
        cases.push_back({.code = "B43",
                         .name = of_discs ? "discs carried by a fast drum" : "boxes carried by a fast drum",
                         .make = [=] { return fast_drum(of_discs); },
                         .run = [=](HardRun& run) { return ride_in_a_fast_drum(run, extent); }});
    return cases;
}

}  // namespace carom::torture

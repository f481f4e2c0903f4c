// B43 of docs/hard-cases.md: bodies that are thrown, within a step, at what they had no contact with.
#include "support/effort.hpp"
#include "support/report.hpp"

#include <carom/carom.hpp>

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60;
constexpr double kHalfPlate = 8, kThickness = 0.2;  // m
constexpr double kApart = 200;                      // m, from one shot to the next

class Draw {
  public:
    explicit Draw(std::uint32_t seed) : random_(seed) {}
    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random_);
    }
    std::size_t below(std::size_t count) { return static_cast<std::size_t>(random_() % count); }

  private:
    std::mt19937 random_;
};

Vec2 turned(double angle, Vec2 p) {
    const double c = std::cos(angle), s = std::sin(angle);
    return {c * p.x - s * p.y, s * p.x + c * p.y};
}

Vec2 seen_from(const BodyState& frame, Vec2 p) {
    return turned(-frame.angle, {p.x - frame.position.x, p.y - frame.position.y});
}

/// Bodies of about a metre.
Shape random_shape(Draw& draw) {
    switch (draw.below(5)) {
        case 0:
            return Disc{0.4};
        case 1:
            return Box{1, draw.uniform(0.2, 1)};
        case 2:
            return Capsule{0.8, draw.uniform(0.1, 0.3)};
        case 3:
            return Polygon{{{-0.5, -0.3}, {0.5, -0.3}, {0, 0.6}}};
        default:
            return Compound{{{.shape = Box{1, 0.3}}, {.shape = Disc{0.3}, .position = {0.5, 0}}}};
    }
}

/// Something long and thin along x that nothing moves.
Shape random_plate(Draw& draw) {
    switch (draw.below(4)) {
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
void add_shot(Scene& scene, Vec2 at, Draw& draw) {
    const Material material{.friction = draw.uniform(0, 1), .restitution = draw.uniform(0, 1)};
    Body plate{.type = BodyType::static_body,
               .shape = random_plate(draw),
               .position = at,
               .angle = draw.uniform(0, 2 * std::numbers::pi),
               .material = material};
    if (draw.below(2) == 0) {
        plate.type = BodyType::kinematic_body;
        plate.velocity = {draw.uniform(-10, 10), draw.uniform(-10, 10)};
        plate.angular_velocity = draw.uniform(-2, 2);
    }
    const auto place = [&](Vec2 p) {
        const Vec2 from = turned(plate.angle, p);
        return Vec2{at.x + from.x, at.y + from.y};
    };
    const Vec2 light{draw.uniform(-2, 2), draw.uniform(0.8, 2)};
    const double steepness = draw.uniform(0.6, 1) * 0.5 * std::numbers::pi, away = draw.uniform(1.5, 4),
                 speed = draw.uniform(100, 300);
    const Vec2 way{std::cos(steepness), -std::sin(steepness)};
    const double beside = draw.uniform(-0.2, 0.2);
    const auto body = [&](Vec2 p, double mass) {
        return Body{.shape = random_shape(draw),
                    .position = place(p),
                    .angle = draw.uniform(0, 2 * std::numbers::pi),
                    .mass = mass,
                    .material = material};
    };
    scene.add(plate);
    scene.add(body(light, 1));
    Body heavy = body({light.x - away * way.x + beside, light.y - away * way.y}, 1000);
    heavy.velocity = turned(plate.angle, {speed * way.x, speed * way.y});
    scene.add(heavy);
}

/// Bodies that got from one side of their plate to the other through it.
template <class Real>
int passed(int shots) {
    Draw draw(43);
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    const int side = static_cast<int>(std::ceil(std::sqrt(shots)));
    for (int i = 0; i < shots; ++i)
        add_shot(scene, {kApart * (i % side - 0.5 * side), kApart * (i / side - 0.5 * side)}, draw);
    BasicWorld<Real> world(scene, {.threads = 1});
    int count = 0;
    std::vector<bool> has_passed(scene.bodies.size());
    std::vector<Vec2> before(scene.bodies.size());
    for (int step = 0; step < 20; ++step) {
        for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
            if (i % 3 == 0) continue;
            const Vec2 now = seen_from(world.state({i - i % 3, 0}), world.state({i, 0}).position);
            const Vec2 then = before[i];
            before[i] = now;
            if (step == 0 || has_passed[i] || !(then.y > 0 && now.y < 0)) continue;
            const double share = then.y / (then.y - now.y), place = then.x + share * (now.x - then.x);
            if (std::abs(place) < kHalfPlate - 0.5) has_passed[i] = true, ++count;
        }
        world.step(kStep);
    }
    return count;
}

}  // namespace

TEST_SUITE("hard cases/tunnelling") {
    TEST_CASE_TEMPLATE("B43: no body that is thrown at a plate within a step passes it", Real, float,
                       double) {
        const int shots = test::scaled(1'000, 200), through = passed<Real>(shots);
        test::report(through, " bodies of ", shots, " shots passed");
        CHECK(through == 0);
    }

    TEST_CASE_TEMPLATE("B43: shapes that a drum throws about do not leave it", Real, float, double) {
        constexpr int kSides = 6, kBodies = 40;
        constexpr double kRadius = 20;  // m, to the corners
        Draw draw(4);
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        Chain loop{.points = {}, .loop = true};
        for (int i = 0; i < kSides; ++i)
            loop.points.push_back(turned(2 * std::numbers::pi * i / kSides, {kRadius, 0}));
        const Material material{.friction = 0.2, .restitution = 1};
        scene.add(
            {.type = BodyType::kinematic_body, .shape = loop, .angular_velocity = -3, .material = material});
        for (int i = 0; i < kBodies; ++i)
            scene.add({.shape = random_shape(draw),
                       .position = {draw.uniform(-10, 10), draw.uniform(-10, 10)},
                       .angle = draw.uniform(0, 6),
                       .velocity = {draw.uniform(-300, 300), draw.uniform(-300, 300)},
                       .material = material});
        BasicWorld<Real> world(scene, {.threads = 1});
        const double inner = kRadius * std::cos(std::numbers::pi / kSides);
        int outside = 0;
        for (int step = 0; step < test::scaled(600, 120); ++step) {
            world.step(kStep);
            for (std::uint32_t i = 1; i <= kBodies; ++i) {
                const Vec2 p = seen_from(world.state({0, 0}), world.state({i, 0}).position);
                double most = 0;
                for (int k = 0; k < kSides; ++k) {
                    const Vec2 n = turned(2 * std::numbers::pi * (k + 0.5) / kSides, {1, 0});
                    most = std::fmax(most, n.x * p.x + n.y * p.y);
                }
                outside += most > inner ? 1 : 0;
            }
        }
        test::report(outside, " times a body was outside");
        CHECK(outside == 0);
    }
}

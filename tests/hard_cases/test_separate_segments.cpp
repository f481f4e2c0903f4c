// Discs and boxes over floors of separate segments, put end to end one by one.
// docs/decisions/0081-turns-and-segments.md.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace test_separate_segments {

using namespace carom;

namespace {

constexpr double kStep = 1.0 / 60, kSpeed = 15, kGravity = 10, kSize = 0.2;  // s, m/s, m/s², m
constexpr int kSegments = 30;                                                // of 1 m

/// A floor of 30 m, from the origin on.
struct Floor {
    double bend = 0;          // rad, from one segment to the next; positive: upwards
    double off = 0;           // m, by which ends miss each other at most, along the floor and across
    double overlap = 0;       // m, of two that are in a line
    bool has_frames = false;  // each has a position and an angle of its own
    bool is_chain = false;
};

/// Whether filters treat all segments alike, or neighbours in different ways; from the start on or after a
/// step.
enum class Filters { alike, apart, alike_later, apart_later };

enum class Slider { smooth_disc, rolling_disc, smooth_box };

void add_floor(Scene& scene, const Floor& floor, const Material& material) {
    std::mt19937 random(3);
    const auto miss = [&] { return floor.off * std::uniform_real_distribution<double>(-1, 1)(random); };
    std::vector<Vec2> points{{0, 0}};
    for (int i = 0; i < kSegments; ++i) {
        const double angle = floor.bend * i;
        points.push_back({points.back().x + std::cos(angle), points.back().y + std::sin(angle)});
    }
    if (floor.is_chain) {
        scene.add({.type = BodyType::static_body, .shape = Chain{points}, .material = material});
        return;
    }
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
        Vec2 a{points[i].x + miss() - floor.overlap, points[i].y + miss()},
            b{points[i + 1].x + miss(), points[i + 1].y + miss()};
        if (i % 3 == 1) std::swap(a, b);
        Body body{.type = BodyType::static_body, .shape = Segment{a, b}, .material = material};
        if (floor.has_frames) {
            const double length = std::hypot(b.x - a.x, b.y - a.y);
            body.position = {(a.x + b.x) / 2, (a.y + b.y) / 2};
            body.angle = std::atan2(b.y - a.y, b.x - a.x);
            body.shape = Segment{{-length / 2, 0}, {length / 2, 0}};
        }
        scene.add(body);
    }
}

/// What is left of the kinetic energy and that of height behind 27 segments, in shares of the first kinetic
/// energy.
template <class Real>
double energy_left(Slider slider, const Floor& floor, Filters filters = Filters::alike) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -kGravity};
    const Material material{.friction = slider == Slider::rolling_disc ? 0.5 : 0};
    add_floor(scene, floor, material);
    const bool begins_alike = filters == Filters::alike || filters == Filters::apart_later;
    for (std::size_t i = 0; i < scene.bodies.size() && !begins_alike; i += 2) scene.bodies[i].category = 2;
    const double start = 1.3;  // m, along the floor
    const double angle = floor.bend, sine = std::sin(angle), cosine = std::cos(angle);
    const Vec2 foot{1 + (start - 1) * cosine, (start - 1) * sine};
    Body body{.position = {foot.x - kSize * sine, foot.y + kSize * cosine},
              .velocity = {kSpeed * cosine, kSpeed * sine},
              .material = material};
    if (slider == Slider::smooth_box)
        body.shape = Box{2 * kSize, 2 * kSize}, body.angle = angle;
    else
        body.shape = Disc{kSize};
    if (slider == Slider::rolling_disc) body.angular_velocity = -kSpeed / kSize;
    const BodyId id = scene.add(body);
    BasicWorld<Real> world(scene, {.threads = 1});
    if (filters == Filters::alike_later || filters == Filters::apart_later) {
        world.step(kStep);
        for (std::uint32_t i = 0; i < id.index; ++i)
            world.set_filter({i, 0},
                             {.category = static_cast<std::uint16_t>(begins_alike && i % 2 == 0 ? 2 : 1)});
        world.set_position(id, body.position), world.set_velocity(id, body.velocity);
        world.set_angular_velocity(id, body.angular_velocity);
    }
    const double spin_share = slider == Slider::rolling_disc ? 0.5 * kSize * kSize : 0;
    const auto energy = [&] {
        const BodyState s = world.state(id);
        return 0.5 * (s.velocity.x * s.velocity.x + s.velocity.y * s.velocity.y +
                      spin_share * s.angular_velocity * s.angular_velocity) +
               kGravity * s.position.y;
    };
    const double before = energy(), kinetic = before - kGravity * body.position.y;
    for (int i = 0; i < 600 && world.state(id).position.x < 0.9 * kSegments; ++i) world.step(kStep);
    CHECK(world.state(id).position.x >= 0.9 * kSegments);
    return 1 + (energy() - before) / kinetic;
}

template <class Real>
void check_like_chain(Slider slider, Floor floor, double bound) {
    CAPTURE(static_cast<int>(slider));
    CAPTURE(floor.bend);
    CAPTURE(floor.off);
    CAPTURE(floor.overlap);
    CAPTURE(floor.has_frames);
    const double left = energy_left<Real>(slider, floor);
    floor.is_chain = true;
    CHECK(std::fabs(left - energy_left<Real>(slider, floor)) < bound);
}

}  // namespace

TEST_SUITE("hard cases/separate segments") {
    TEST_CASE_TEMPLATE("what slides or rolls over segments that meet loses what it loses on a chain", Real,
                       float, double) {
        for (const Slider slider : {Slider::smooth_disc, Slider::rolling_disc, Slider::smooth_box})
            for (const double bend : {0.0, 0.01, -0.01})
                for (const double off : {0.0, 1e-7})
                    for (const bool has_frames : {false, true})
                        check_like_chain<Real>(slider, {.bend = bend, .off = off, .has_frames = has_frames},
                                               1e-3);
    }
    TEST_CASE_TEMPLATE("ends that lie on the next segment are not felt", Real, float, double) {
        for (const Slider slider : {Slider::smooth_disc, Slider::rolling_disc, Slider::smooth_box})
            for (const double overlap : {1e-7, 1e-3})
                CHECK(energy_left<Real>(slider, {.overlap = overlap}) == doctest::Approx(1).epsilon(1e-4));
    }
    TEST_CASE("segments keep their points, and are alone again when the next is gone or elsewhere") {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.gravity = {0, -kGravity};
        const BodyId left = scene.add({.type = BodyType::static_body, .shape = Segment{{0, 0}, {1, 0}}});
        const BodyId right =
            scene.add({.type = BodyType::static_body, .shape = Segment{{1, 0}, {0, 0}}, .position = {1, 0}});
        const BodyId disc = scene.add({.shape = Disc{kSize}, .position = {0.5, kSize}});
        World world(scene, {.threads = 1});
        world.step(kStep);
        const Segment kept = std::get<Segment>(world.shape(right));
        CHECK(kept.a.x == 1);
        CHECK(kept.b.x == 0);
        world.set_position(right, {1, -5});
        // Over the end that is free now it falls down, and on the other segment it rests.
        world.set_velocity(disc, {2, 0});
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state(disc).position.y < -1);
        world.set_position(right, {1, 0});
        world.set_position(disc, {0.5, kSize});
        world.set_velocity(disc, {1.5, 0});
        for (int i = 0; i < 30; ++i) world.step(kStep);
        CHECK(world.state(disc).position.y == doctest::Approx(kSize).epsilon(1e-3));
        world.remove(left);
        for (int i = 0; i < 10; ++i) world.step(kStep);
        CHECK(world.state(disc).position.y == doctest::Approx(kSize).epsilon(1e-3));
    }
    TEST_CASE_TEMPLATE("segments that come to be filtered alike are joined, others are parted", Real, float,
                       double) {
        const Floor floor{.bend = -0.01, .off = 1e-7};
        const double joined = energy_left<Real>(Slider::smooth_disc, floor),
                     parted = energy_left<Real>(Slider::smooth_disc, floor, Filters::apart);
        CHECK(parted < 0.97);
        CHECK(joined > 0.99);
        CHECK(energy_left<Real>(Slider::smooth_disc, floor, Filters::alike_later) == joined);
        CHECK(energy_left<Real>(Slider::smooth_disc, floor, Filters::apart_later) == parted);
    }
}

}  // namespace test_separate_segments

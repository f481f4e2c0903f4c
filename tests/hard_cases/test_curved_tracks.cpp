// Discs that slide and roll inside curves made of edges. docs/decisions/0076-curved-tracks.md.
#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "support/report.hpp"
#include "support/scenes.hpp"

namespace test_curved_tracks {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kCircle = 2, kRadius = 0.2, kWay = kCircle - kRadius;  // s; m
constexpr double kPi = std::numbers::pi;

/// A disc at the bottom of a closed loop, that starts along it.
struct Loop {
    int edges = 1000;
    double speed = 10;  // m/s
    Material material{};
    double gravity = 0;          // m/s², downwards
    bool repeats_first = false;  // its last point is the first one, in place of a last line that leads there
};

Scene scene_of(const Loop& loop) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -loop.gravity};
    scene.effects.ledger = true;
    Chain circle{.points = {}, .loop = !loop.repeats_first};
    for (int i = 0; i < loop.edges + (loop.repeats_first ? 1 : 0); ++i) {
        const double at = 2 * kPi * (i + 0.5) / loop.edges - kPi / 2;
        circle.points.push_back({kCircle * std::cos(at), kCircle * std::sin(at)});
    }
    scene.add({.type = BodyType::static_body, .shape = circle, .material = loop.material});
    scene.add({.shape = Disc{kRadius},
               .position = {0, kRadius - kCircle * std::cos(kPi / loop.edges)},  // it touches an edge
               .velocity = {loop.speed, 0},
               .angular_velocity = loop.material.friction > 0 ? -loop.speed / kRadius : 0,
               .material = loop.material});
    return scene;
}

/// What a disc in a loop did.
struct Seen {
    double left, most;    ///< kinetic energy of both kinds and that of height, in shares of the first kinetic
    double farthest = 0;  ///< m, from the circle on which its middle should be
    Vec2 unexplained;     ///< N s
};

template <class Real>
Seen run(const Loop& loop, double turns) {
    BasicWorld<Real> world(scene_of(loop), {.threads = 1});
    const BodyId disc{1, 0};
    const auto energy = [&] { return world.ledger().energy.total(); };
    // What may bounce is held from its first bounce on.
    for (int i = 0; loop.material.restitution > 0 && i < 10; ++i) world.step(kStep);
    const double start = energy(), kinetic = world.ledger().energy.kinetic + world.ledger().energy.rotational;
    Seen seen{1, 1, 0, {}};
    for (double time = 0; time < turns * 2 * kPi * kWay / loop.speed; time += kStep) {
        world.step(kStep);
        const Vec2 p = world.state(disc).position;
        seen.farthest = std::fmax(seen.farthest, std::fabs(std::hypot(p.x, p.y) - kWay));
        seen.left = 1 + (energy() - start) / kinetic;
        seen.most = std::fmax(seen.most, seen.left);
    }
    seen.unexplained = world.ledger().momentum_by_cause.unexplained;
    return seen;
}

/// A disc that is let go in half a pipe. @return the height that it reaches in the last of some swings, over
/// that from which it started
template <class Real>
double height_kept(int edges, double friction, double seconds) {
    constexpr double kPipe = 3, kBall = 0.25, kSwing = 1.2;  // m; rad
    Scene scene;
    scene.gravity = {0, -9.81};
    Chain pipe;
    for (int i = 0; i <= edges; ++i) {
        const double at = kPi * i / edges - kPi;
        pipe.points.push_back({kPipe * std::cos(at), kPipe * std::sin(at)});
    }
    const Material material{.friction = friction};
    scene.add({.type = BodyType::static_body, .shape = pipe, .material = material});
    const double low = -(kPipe - kBall), start = low * std::cos(kSwing);
    const BodyId ball =
        scene.add({.shape = Disc{kBall}, .position = {low * std::sin(kSwing), start}, .material = material});
    BasicWorld<Real> world(scene, {.threads = 1});
    double highest = low;
    for (double time = 0; time < seconds; time += kStep) {
        world.step(kStep);
        if (time > seconds - 5) highest = std::fmax(highest, world.state(ball).position.y);
    }
    return (highest - low) / (start - low);
}

}  // namespace

TEST_SUITE("hard cases/curved tracks") {
    // Every step took v² θ² / 2, θ = v dt / R: at 20 m/s half of the energy was gone in a turn.
    TEST_CASE_TEMPLATE("a disc keeps its energy in a loop of many edges", Real, float, double) {
        for (const int edges : {64, 200, 1000})
            for (const double friction : {0.0, 0.8})
                for (const double speed : {2.0, 5.0, 10.0, 20.0}) {
                    CAPTURE(edges);
                    CAPTURE(friction);
                    CAPTURE(speed);
                    const Seen seen = run<Real>({edges, speed, {.friction = friction}}, 5);
                    report(edges, " edges, friction ", friction, ", ", speed, " m/s: left after five turns ",
                           seen.left, ", from its circle ", seen.farthest, " m");
                    CHECK(seen.left > 0.999);
                    CHECK(seen.most < 1 + 1e-5);
                    CHECK(seen.farthest < 0.06 * kRadius);
                    CHECK(std::hypot(seen.unexplained.x, seen.unexplained.y) < 1e-5);
                }
    }

    TEST_CASE_TEMPLATE("a chain that comes back to its first point is a loop", Real, float, double) {
        for (const double speed : {2.0, 10.0}) {
            const Seen seen = run<Real>({.edges = 200, .speed = speed, .repeats_first = true}, 5);
            report(speed, " m/s: left after five turns ", seen.left);
            CHECK(seen.left > 0.999);
            CHECK(seen.most < 1 + 1e-5);
            CHECK(seen.farthest < 0.06 * kRadius);
        }
        const BasicWorld<Real> world(scene_of({.edges = 200, .repeats_first = true}));
        const Chain kept = std::get<Chain>(world.shape({0, 0}));
        CHECK(kept.loop);
        CHECK(kept.points.size() == 200);
    }

    TEST_CASE_TEMPLATE("a disc goes round a loop against gravity as energy says", Real, float, double) {
        for (const double friction : {0.0, 0.8})
            for (const double restitution : {0.0, 0.5}) {
                CAPTURE(friction);
                CAPTURE(restitution);
                const Seen seen =
                    run<Real>({400, 12, {.friction = friction, .restitution = restitution}, 9.81}, 3);
                report("friction ", friction, ", restitution ", restitution, ": left ", seen.left);
                CHECK(seen.left > 0.999);
                CHECK(seen.most < 1.005);
                CHECK(seen.farthest < 0.1 * kRadius);
            }
    }

    TEST_CASE_TEMPLATE("a disc swings in half a pipe as high as it started", Real, float, double) {
        for (const int edges : {200, 800})
            for (const double friction : {0.0, 0.9}) {
                CAPTURE(edges);
                CAPTURE(friction);
                // About 2.6 s a swing to and fro, 3.2 s for one that rolls.
                const double kept = height_kept<Real>(edges, friction, 20);
                report(edges, " edges, friction ", friction, ": height kept in 20 s ", kept);
                CHECK(kept > 0.96);
                CHECK(kept < 1.002);
            }
    }

    // A bend of more than kSmoothBend is no curve: what has no restitution keeps what it has along the second
    // edge.
    TEST_CASE_TEMPLATE("a corner takes from a disc what its edge faces", Real, float, double) {
        for (const double bend : {0.3, 0.6, 1.0}) {
            CAPTURE(bend);
            Scene scene;
            scene.accuracy.solver = Solver::soft;
            const Chain track{.points = {{-4, 0}, {0, 0}, {4 * std::cos(bend), 4 * std::sin(bend)}}};
            scene.add({.type = BodyType::static_body, .shape = track});
            const BodyId disc =
                scene.add({.shape = Disc{kRadius}, .position = {-2, kRadius}, .velocity = {5, 0}});
            BasicWorld<Real> world(scene, {.threads = 1});
            for (int i = 0; i < 40; ++i) world.step(kStep);
            const Vec2 v = world.state(disc).velocity;
            CHECK(std::hypot(v.x, v.y) == doctest::Approx(5 * std::cos(bend)).epsilon(0.01));
        }
    }
}

}  // namespace test_curved_tracks

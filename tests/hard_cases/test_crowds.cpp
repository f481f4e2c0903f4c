// B16 and B31 of docs/hard-cases.md: crowds.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace test_crowds {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;  // s

struct Crowded {
    double while_driven = 0, after = 0;  // largest overlap, as a fraction of the smaller radius
    double bytes_per_body = 0;
};

/// Pulls the first `count` bodies to the origin with acceleration `pull` [m/s²] for a while, then leaves them
/// alone for two seconds.
template <class Real>
Crowded crowd(const Scene& scene, std::size_t count, double pull, int driven_steps) {
    BasicWorld<Real> world(scene, {.threads = 1});
    Crowded result;
    for (int i = 0; i < driven_steps; ++i) {
        for (std::uint32_t b = 0; b < count; ++b) {
            const BodyState s = world.state({b, 0});
            const double r = std::hypot(s.position.x, s.position.y);
            if (r == 0) continue;
            const double dv = -pull * kStep / r;
            world.set_velocity({b, 0}, {s.velocity.x + dv * s.position.x, s.velocity.y + dv * s.position.y});
        }
        world.step(kStep);
        result.while_driven = std::fmax(result.while_driven, world.overlaps().max);
    }
    for (int i = 0; i < 120; ++i) world.step(kStep);
    result.after = world.overlaps().max;
    result.bytes_per_body =
        static_cast<double>(world.profile().bytes) / static_cast<double>(scene.bodies.size());
    CHECK(world.quarantined().empty());
    report(scene.bodies.size(), " bodies: overlap ", result.while_driven, " while driven, ", result.after,
           " two seconds later, ", result.bytes_per_body, " bytes a body");
    return result;
}

Scene lattice_around_origin(std::int64_t side, double spacing, double jitter, double radius) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    Lattice lattice;
    lattice.count_x = lattice.count_y = side;
    const double corner = -0.5 * spacing * static_cast<double>(side - 1);
    lattice.origin = {corner, corner}, lattice.spacing = {spacing, spacing};
    lattice.jitter = jitter;
    lattice.body.shape = Disc{radius};
    add_lattice(scene, lattice);
    return scene;
}

struct Poured {
    double while_pouring = 0, after = 0;  // largest overlap, as a fraction of the smaller radius
    double lowest = 0;                    // m, of all centres
};

/// Pours 300 discs that start at `speed` [m/s] into a funnel whose mouth is too narrow for one.
template <class Real>
Poured pour(double speed) {
    constexpr double kRadius = 0.5;
    Scene scene;
    scene.gravity = {0, -10};
    scene.accuracy.solver = Solver::soft;
    const Material rough{.friction = 0.8};
    const double mouth = 1.1 * kRadius;
    for (const std::vector<Vec2>& side : {std::vector<Vec2>{{-mouth - 8, 60}, {-mouth - 8, 10}, {-mouth, 0}},
                                          std::vector<Vec2>{{mouth, 0}, {mouth + 8, 10}, {mouth + 8, 60}}})
        scene.add({.type = BodyType::static_body, .shape = Chain{side}, .material = rough});
    const std::size_t first = scene.bodies.size();
    for (int i = 0; i < 300; ++i)
        scene.add({.shape = Disc{kRadius * (1.15 + 0.05 * (i % 4))},
                   .position = {-7.2 + 1.32 * (i % 12), 12 + 1.32 * (i / 12)},
                   .velocity = {0, -speed},
                   .material = rough});
    BasicWorld<Real> world(scene, {.threads = 1});
    Poured result;
    for (int i = 0; i < 360; ++i) {
        world.step(kStep);
        result.while_pouring = std::fmax(result.while_pouring, world.overlaps().max);
    }
    for (int i = 0; i < 120; ++i) world.step(kStep);
    result.after = world.overlaps().max, result.lowest = 1e9;
    for (std::size_t i = first; i < scene.bodies.size(); ++i)
        result.lowest = std::fmin(result.lowest, world.state({static_cast<std::uint32_t>(i), 0}).position.y);
    CHECK(world.quarantined().empty());
    return result;
}

/// Discs of .2 to .5 m that fall into a box, 600 of them from up to 30 m.
Scene falling(double restitution, double friction, unsigned seed, int count = 600) {
    Scene scene = gas_scene({.count = count,
                             .packing_fraction = 0.35,
                             .velocity_rms = 1,
                             .restitution = restitution,
                             .smallest_radius = 0.2,
                             .largest_radius = 0.5,
                             .seed = seed});
    scene.gravity = {0, -10};
    scene.walls->min.y -= 5;  // m, that the lowest discs fall
    scene.walls->top = false;
    scene.walls->material.friction = friction;
    for (Body& body : scene.bodies) body.material.friction = friction;
    return scene;
}

constexpr int kStepsToFall = 260;

/// Adds discs that do not move to the floor, and one that goes along it.
void add_obstacles(Scene& scene) {
    const Walls& box = *scene.walls;
    const double width = box.max.x - box.min.x;
    for (int i = 0; i < 6; ++i)
        scene.add({.type = BodyType::static_body,
                   .shape = Disc{0.5},
                   .position = {box.min.x + width * (i + 0.5) / 6, box.min.y - 0.1},
                   .material = box.material});
    scene.add({.type = BodyType::kinematic_body,
               .shape = Disc{0.5},
               .position = {box.min.x + 0.15 * width, box.min.y + 2.2},
               .velocity = {0.2, 0},
               .material = box.material});
}

/// The largest overlap of discs while they fall, in radii of the smaller one.
double overlap_of_falling(const Scene& scene) {
    World world(scene, {.threads = 1});
    double overlap = 0;
    for (int i = 0; i < kStepsToFall; ++i) {
        world.step(kStep);
        overlap = std::max(overlap, world.overlaps().max);
    }
    return overlap;
}

/// Discs on each other on the floor that a larger one hits.
struct Column {
    double overlap = 0;  // the largest of some steps, in radii of the smaller one
    double rising = 0;   // m/s, the fastest after these
};
template <class Real>
Column hit_column(int count, double restitution, double speed, double above, int steps) {
    constexpr double kSmall = 0.25, kLarge = 0.5;  // m
    Scene scene;
    scene.gravity = {0, -10};
    scene.walls = floor_at(0);
    scene.accuracy.solver = Solver::soft;
    const Material rough{.friction = 0.3, .restitution = restitution};
    scene.walls->material = rough;
    for (int i = 0; i < count; ++i)
        scene.add({.shape = Disc{kSmall}, .position = {0, kSmall * (2 * i + 1)}, .material = rough});
    scene.add({.shape = Disc{kLarge},
               .position = {0, 2 * kSmall * count + kLarge + above},
               .velocity = {0, -speed},
               .material = rough});
    BasicWorld<Real> world(scene, {.threads = 1});
    Column found;
    for (int i = 0; i < steps; ++i) {
        world.step(kStep);
        found.overlap = std::max(found.overlap, world.overlaps().max);
    }
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i)
        found.rising = std::max(found.rising, world.state({i, 0}).velocity.y);
    report(count, " discs of restitution ", restitution, ": overlap ", found.overlap, ", rising at ",
           found.rising, " m/s");
    return found;
}

}  // namespace

TEST_SUITE("hard cases/crowds") {
    TEST_CASE_TEMPLATE("B16: four hundred discs that rush to a point", Real, float, double) {
        const Crowded found = crowd<Real>(lattice_around_origin(20, 2, 0.3, 0.5), 400, 10, scaled(300, 150));
        CHECK(found.while_driven < 0.2);
        CHECK(found.after < 0.01);
    }

    // A cell of the grid is as large as the bodies of its level: the large disc's cell holds all the others.
    TEST_CASE_TEMPLATE("B16: ten thousand discs in one cell of a large one's level, pulled together", Real,
                       float, double) {
        const int kSide = scaled(100, 40);
        constexpr double kRadius = 0.05, kLarge = 10;
        Scene scene = lattice_around_origin(kSide, 2.4 * kRadius, 0.1 * kRadius, kRadius);
        scene.add({.shape = Disc{kLarge}, .position = {kLarge + 10, 0}});
        const Crowded found =
            crowd<Real>(scene, static_cast<std::size_t>(kSide * kSide), 0.25, scaled(600, 100));
        CHECK(found.while_driven < 0.2);
        CHECK(found.after < 0.01);
        CHECK(found.bytes_per_body < 2000);
    }

    TEST_CASE_TEMPLATE("B16: a crowd in one point costs a bounded number of contacts a body", Real, float,
                       double) {
        const int kCount = scaled(2000, 600);
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        for (int i = 0; i < kCount; ++i)
            scene.add({.shape = Disc{0.5}, .position = {1, 2}, .material = {.friction = 0.3}});
        BasicWorld<Real> world(scene, {.threads = 1});
        world.step(kStep);
        const Profile profile = world.profile();
        const double contacts = static_cast<double>(profile.contacts) / kCount,
                     bytes = static_cast<double>(profile.bytes) / kCount;
        report(kCount, " bodies in one point: ", contacts, " contacts and ", bytes, " bytes a body");
        CHECK(contacts > 10);
        CHECK(contacts < 40);
        CHECK(bytes < 30000);
        CHECK(world.quarantined().empty());
    }

    // With impacts alone up to .14 of the smaller radius.
    TEST_CASE("a crowd that falls on itself is not pressed into each other, whatever bounces") {
        int number = 0;
        for (const double friction : {0.0, 0.3})
            for (const double restitution : {0.1, 0.3, 0.6, 0.8, 0.95}) {
                if (number++ % scaled(1, 3) > 0) continue;
                CAPTURE(restitution);
                CAPTURE(friction);
                const double overlap = overlap_of_falling(falling(restitution, friction, 1));
                report("restitution ", restitution, ", friction ", friction, ": largest overlap ", overlap,
                       " of the smaller radius");
                CHECK(overlap < 0.1);
            }
    }

    // With impacts alone up to .15 of the smaller radius.
    TEST_CASE("nor is one that falls on what does not move, or goes its way") {
        for (const double restitution : scaled<std::vector<double>>({0.1, 0.3, 0.6, 0.9}, {0.3, 0.9})) {
            CAPTURE(restitution);
            Scene scene = falling(restitution, 0.3, 1);
            add_obstacles(scene);
            const double overlap = overlap_of_falling(scene);
            report("restitution ", restitution, ": largest overlap ", overlap, " of the smaller radius");
            CHECK(overlap < 0.1);
        }
    }

    TEST_CASE("what a crowd that bounces presses is in the books, to round-off") {
        for (const double friction : {0.0, 0.3})
            for (const double restitution : {0.3, 0.9}) {
                if (is_effort_reduced() && (friction > 0) != (restitution == 0.3)) continue;
                CAPTURE(restitution);
                CAPTURE(friction);
                Scene scene = falling(restitution, friction, 2);
                if (friction > 0) add_obstacles(scene);
                World64 world(scene, {.threads = 1, .effects = {.ledger = true}});
                for (int i = 0; i < kStepsToFall; ++i) world.step(kStep);
                const Ledger ledger = world.ledger();
                const EnergyByCause& energy = ledger.energy_by_cause;
                const Vec2 momentum = ledger.momentum_by_cause.unexplained;
                CHECK((energy.drive != 0) == (friction > 0));
                const double taken = -energy.restitution - energy.friction;  // J
                const double given = std::hypot(ledger.momentum_by_cause.walls.x,
                                                ledger.momentum_by_cause.walls.y);  // kg m/s
                report("restitution ", restitution, ", friction ", friction, ": unexplained ",
                       energy.unexplained / taken, " of the energy taken, ",
                       std::hypot(momentum.x, momentum.y) / given, " of the momentum given");
                CHECK(taken > 1e4);
                CHECK(std::fabs(energy.unexplained) < 1e-12 * taken);
                CHECK(std::hypot(momentum.x, momentum.y) < 1e-12 * given);
            }
    }

    TEST_CASE_TEMPLATE(
        "a crowd that bounces has the same bits for all threads and instruction sets, and goes on alike",
        Real, float, double) {
        constexpr int kBefore = 90, kAfter = 30;  // steps: the lowest third has fallen by then
        const Scene scene = falling(0.5, 0.3, 3, 3000);
        BasicWorld<Real> world(scene, {.threads = 1});
        for (int i = 0; i < kBefore; ++i) world.step(kStep);
        BasicWorld<Real> copy(world);
        for (int i = 0; i < kAfter; ++i) world.step(kStep), copy.step(kStep);
        CHECK(world.overlaps().max > 0.01);  // it is pressed
        CHECK(copy.state_hash() == world.state_hash());
        for (const std::string& isa : runnable_instruction_sets()) {
            CAPTURE(isa);
            BasicWorld<Real> again(scene, {.isa = isa, .threads = 3});
            for (int i = 0; i < kBefore + kAfter; ++i) again.step(kStep);
            CHECK(again.state_hash() == world.state_hash());
        }
    }

    // What lies on each other is one body to what hits it. With impacts alone .09 to .13 of the smaller
    // radius.
    TEST_CASE_TEMPLATE("discs on each other are not pressed by a larger one that bounces off them", Real,
                       float, double) {
        for (const int count : {4, 6})
            for (const double restitution : {0.2, 0.5}) {
                CAPTURE(count);
                CAPTURE(restitution);
                CHECK(hit_column<Real>(count, restitution, 20, 2.5, 30).overlap < 0.08);
            }
    }

    // Two sweeps a substep alone leave up to .16 of the smaller radius.
    TEST_CASE("a rough crowd that falls on itself without bouncing is not pressed into each other") {
        for (const unsigned seed : {1u, 2u, 3u, 4u}) {
            CAPTURE(seed);
            const double overlap = overlap_of_falling(falling(0, 0.3, seed));
            report("seed ", seed, ": largest overlap ", overlap, " of the smaller radius");
            CHECK(overlap < 0.1);
        }
    }

    // Nothing bounces and the floor does not move, so that all stop in the instant of the hit, touching. Two
    // sweeps a substep alone leave .14 to .29 of the smaller radius, and up to 7 m/s behind it.
    TEST_CASE_TEMPLATE("discs on each other that are hit by a larger one stop where they are", Real, float,
                       double) {
        constexpr double kSpeed = 20;  // m/s
        for (const int count : {2, 3, 4, 5, 6, 8}) {
            CAPTURE(count);
            const Column found = hit_column<Real>(count, 0, kSpeed, 0.5 * kSpeed * kStep, 4);
            CHECK(found.overlap < 0.1);
            CHECK(found.rising < 0.25 * kSpeed);
        }
    }

    TEST_CASE_TEMPLATE("B16: discs poured into a funnel jam and come apart again", Real, float, double) {
        // A column that falls is stopped from below, one disc after the other, several within a step.
        double deepest = 0, after = 0, lowest = 1e9;
        const int kRuns = scaled(24, 4);
        for (int i = 0; i < kRuns; ++i) {
            const Poured found = pour<Real>(5 + 6.0 * i / kRuns);
            deepest = std::fmax(deepest, found.while_pouring), after = std::fmax(after, found.after);
            lowest = std::fmin(lowest, found.lowest);
        }
        report("funnel, ", kRuns, " starting velocities: overlap ", deepest, " while pouring, ", after,
               " two seconds later, lowest at ", lowest, " m");
        CHECK(deepest < 0.2);
        CHECK(after < 0.01);
        CHECK(lowest > 0);  // no disc is pressed through the mouth
    }
}

}  // namespace test_crowds

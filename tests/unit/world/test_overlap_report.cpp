// World::overlaps against a loop over all pairs of bodies, which knows no candidates, and against a world
// that is not measured.
#include "support/effort.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

namespace test_overlap_report {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

struct Overlap {
    std::int64_t touching = 0;
    double mean = 0, max = 0;  // fractions of the smaller radius
};

/// Over all pairs and walls; quarantined bodies take no part, and no pair of two bodies that never move.
template <class Real>
Overlap overlap_of_all_pairs(const Scene& scene, const BasicWorld<Real>& world) {
    Overlap overlap;
    const auto add = [&](double separation, double radius) {
        if (!(separation < 0)) return;
        ++overlap.touching;
        overlap.mean -= separation / radius;
        overlap.max = std::fmax(overlap.max, -separation / radius);
    };
    const std::vector<BodyId> out = world.quarantined();
    std::vector<bool> takes_part(scene.bodies.size(), true);
    for (const BodyId id : out) takes_part[id.index] = false;
    std::vector<Vec2> x;
    std::vector<double> radius;  // m, as a world of this precision has it
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
        x.push_back(world.state({i, 0}).position);
        radius.push_back(
            static_cast<double>(static_cast<Real>(std::get<Disc>(scene.bodies[i].shape).radius)));
    }
    const auto is_dynamic = [&](std::size_t i) { return scene.bodies[i].type == BodyType::dynamic_body; };
    for (std::size_t i = 0; i < x.size(); ++i)
        for (std::size_t j = i + 1; j < x.size() && takes_part[i]; ++j)
            if (takes_part[j] && (is_dynamic(i) || is_dynamic(j)))
                add(std::sqrt((x[j].x - x[i].x) * (x[j].x - x[i].x) + (x[j].y - x[i].y) * (x[j].y - x[i].y)) -
                        radius[i] - radius[j],
                    std::fmin(radius[i], radius[j]));
    for (std::size_t i = 0; i < x.size() && scene.walls; ++i) {
        if (!takes_part[i] || !is_dynamic(i)) continue;
        if (scene.walls->left) add(x[i].x - scene.walls->min.x - radius[i], radius[i]);
        if (scene.walls->right) add(scene.walls->max.x - x[i].x - radius[i], radius[i]);
        if (scene.walls->bottom) add(x[i].y - scene.walls->min.y - radius[i], radius[i]);
        if (scene.walls->top) add(scene.walls->max.y - x[i].y - radius[i], radius[i]);
    }
    if (overlap.touching > 0) overlap.mean /= static_cast<double>(overlap.touching);
    return overlap;
}

template <class Real>
void check_report(const Scene& scene, const BasicWorld<Real>& world) {
    const Overlap expected = overlap_of_all_pairs(scene, world);
    const OverlapReport report = world.overlaps();
    CHECK(report.touching == expected.touching);
    CHECK(report.candidates >= report.touching);
    CHECK(report.max == doctest::Approx(expected.max).epsilon(1e-12));
    CHECK(report.mean == doctest::Approx(expected.mean).epsilon(1e-12));
}

/// A heap that falls, at rest below and in free fall above: bodies leave their margins all the time.
Scene falling_heap() {
    Scene scene;
    scene.gravity = {0, -10};
    const Material rough{.friction = 0.4};
    scene.walls = Walls{.min = {0, 0}, .max = {15, 200}, .top = false, .material = rough};
    Lattice lattice;
    lattice.count_x = 11, lattice.count_y = 30;
    lattice.origin = {0.7, 0.7}, lattice.spacing = {1.3, 1.6};
    lattice.jitter = 0.1;
    lattice.radius_range = RadiusRange{0.3, 0.55};
    lattice.body.material = rough;
    add_lattice(scene, lattice);
    scene.add({.type = BodyType::static_body, .shape = Disc{2}, .position = {7, 1}, .material = rough});
    scene.add({.type = BodyType::static_body, .shape = Disc{2}, .position = {8, 1}, .material = rough});
    return scene;
}

}  // namespace

TEST_SUITE("world/overlap report") {
    TEST_CASE_TEMPLATE("every pair that overlaps is in the report, also between rebuilds of the candidates",
                       Real, float, double) {
        const Scene scene = falling_heap();
        BasicWorld<Real> world(scene);
        REQUIRE(world.plan().solver == "soft");
        check_report(scene, world);
        std::int64_t between_rebuilds = 0;
        for (int i = 0; i < 240; ++i) {
            const std::int64_t rebuilds = world.profile().rebuilds;
            world.step(kStep);
            between_rebuilds += world.profile().rebuilds == rebuilds;
            CAPTURE(i);
            if (i % scaled(1, 7) == 0) check_report(scene, world);
        }
        CHECK(between_rebuilds > 100);
        CHECK(world.overlaps().touching > 400);
    }

    TEST_CASE("pairs of sleeping bodies are in the report like all others") {
        Scene scene = falling_heap();
        scene.effects.sleep = true;
        World world(scene);
        for (int i = 0; i < 900 && world.profile().asleep < 300; ++i) world.step(kStep);
        REQUIRE(world.profile().asleep >= 300);
        check_report(scene, world);
        world.step(kStep);
        check_report(scene, world);
    }

    TEST_CASE("overlaps that the scene starts with are in the report under every solver that takes them") {
        Scene scene = falling_heap();
        scene.bodies.resize(60), scene.walls->top = true, scene.walls->max.y = 12;
        for (Body& body : scene.bodies) body.material = {}, body.position.y *= 0.3;
        scene.walls->material = {};
        for (const Solver solver : {Solver::impulse, Solver::soft}) {
            World world(scene, {.solver = solver});
            check_report(scene, world);
            for (int i = 0; i < 5; ++i) {
                world.step(kStep);
                check_report(scene, world);
            }
        }
    }

    TEST_CASE_TEMPLATE("measuring overlaps changes neither the bits of a world nor its candidates", Real,
                       float, double) {
        Scene scene = falling_heap();
        for (const bool sleeps : {false, true}) {
            scene.effects.sleep = sleeps;
            BasicWorld<Real> measured(scene), alone(scene);
            for (int i = 0; i < 120; ++i) {
                measured.overlaps();
                measured.step(kStep), alone.step(kStep);
                if (i == 60) measured.remove({5, 0}), alone.remove({5, 0});
            }
            CHECK(measured.state_hash() == alone.state_hash());
            CHECK(measured.profile().rebuilds == alone.profile().rebuilds);
            CHECK(measured.profile().candidate_pairs == alone.profile().candidate_pairs);
        }
    }

    TEST_CASE(
        "two compounds that overlap with several pieces are one pair, as deep as their deepest pieces") {
        // Crosses of two bars, 0.2 m thick, on each other: each bar overlaps both of the other's.
        Compound cross;
        cross.pieces = {{.shape = Box{2, 0.2}}, {.shape = Box{0.2, 2}}};
        Scene scene;
        scene.add({.shape = cross});
        scene.add({.shape = cross, .position = {0.05, 0}});
        const OverlapReport report = World(scene).overlaps();
        CHECK(report.candidates == 1);
        CHECK(report.touching == 1);
        // Deepest is where an upright bar crosses a lying one: 1 + 0.1 - 0.05 m to its end. A bar's inradius
        // is 0.1 m.
        CHECK(report.max == doctest::Approx(10.5).epsilon(1e-5));
        CHECK(report.mean == report.max);
    }
}

}  // namespace test_overlap_report

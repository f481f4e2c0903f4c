// B31, B32 of docs/hard-cases.md: what bounces, collapses and lies still in one world under solver `soft`.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"
#include "torture/energy_rule.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace test_bouncing {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Discs of a lattice that fall into a box. @param mixed  whether restitutions are from 0.3 up
Scene dropped(int columns, int rows, double restitution, double friction) {
    Scene scene;
    scene.accuracy.solver = Solver::soft;
    scene.gravity = {0, -9.81};
    scene.walls = Walls{.min = {0, 0}, .max = {1.2 * columns + 2.0, 1e4}, .top = false};
    scene.walls->material = {.friction = friction, .restitution = restitution};
    Lattice lattice;
    lattice.count_x = columns, lattice.count_y = rows, lattice.spacing = {1.2, 1.2};
    lattice.origin = {1.5, 2.5}, lattice.jitter = 0.05, lattice.seed = 3, lattice.radius_range = {0.4, 0.5};
    lattice.body.material = {.friction = friction, .restitution = restitution};
    add_lattice(scene, lattice);
    return scene;
}

/// What bounces from everything there is: walls, a segment, a static disc, with drag, friction and rolling
/// resistance. Without gravity nothing comes to rest in the time that is looked at.
Scene everything(bool falls = true) {
    Scene scene = dropped(10, 10, 0.6, 0.3);
    if (!falls) scene.gravity = {}, scene.walls->max.y = 14.5, scene.walls->top = true;
    scene.drag = {.linear = 0.05, .angular = 0.05};
    for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
        Body& body = scene.bodies[i];
        body.material.restitution = 0.3 + 0.1 * static_cast<double>(i % 8);
        body.material.friction = i % 3 == 0 ? 0 : 0.4;
        body.material.rolling_resistance = i % 5 == 0 ? 0.1 : 0;
        body.fixed_rotation = i % 7 == 0;
        body.velocity = {i % 2 == 0 ? 3.0 : -3.0, i % 4 == 0 ? 2.0 : -1.0};
    }
    scene.add({.type = BodyType::static_body,
               .shape = Segment{{1, 2}, {6, 0.8}},
               .material = {.friction = 0.3, .restitution = 0.9}});
    scene.add(
        {.type = BodyType::static_body, .shape = Disc{0.8}, .position = {10, 0.9}, .material = bouncy(1)});
    return scene;
}

struct Counts {
    std::int64_t most = 0, all = 0;  // impacts, in a step and ever
    double overlap = 0;              // m
    double highest = 0;              // J
};

template <class Real>
Counts run_and_count(BasicWorld<Real>& world, int steps) {
    Counts counts;
    for (int i = 0; i < steps; ++i) {
        world.step(kStep);
        const std::int64_t impacts = world.profile().impacts;
        counts.most = std::max(counts.most, impacts - counts.all), counts.all = impacts;
        counts.overlap = std::max(counts.overlap, world.overlaps().max);
        counts.highest = std::max(counts.highest, world.ledger().energy.total());
    }
    return counts;
}

}  // namespace

TEST_SUITE("hard cases/bouncing") {
    TEST_CASE_TEMPLATE("B31: of a crowd that collapses no step has more impacts than five a body", Real,
                       float, double) {
        for (const bool falls : {false, true}) {
            CAPTURE(falls);
            Scene scene = dropped(10, 20, 0.9, 0.2);
            if (!falls) {
                scene = gas_scene({.count = 300, .packing_fraction = 0.8, .restitution = 0.5});
                scene.accuracy.solver = Solver::soft;
            }
            BasicWorld<Real> world(scene, {.threads = 1, .effects = {.ledger = true}});
            const double start = world.ledger().energy.total();
            const Counts counts = run_and_count(world, scaled(1200, 600));
            report(falls ? "dropped" : "gas of .5", ": at most ", counts.most, " impacts a step, ",
                   counts.all, " in all, bounces ", world.profile().bounces, ", overlap ", counts.overlap,
                   " m, energy up by ", counts.highest / start - 1, ", left ",
                   world.ledger().energy.total() / start);
            CHECK(counts.most <= 5 * static_cast<std::int64_t>(world.body_count()));
            CHECK(counts.overlap < (falls ? 0.2 : 0.04) * 0.4);
            CHECK(counts.highest <= start * (1 + 1e-6));
        }
    }

    TEST_CASE_TEMPLATE(
        "B31: no step gives energy by restitution or friction, and what a kinematic disc gives is its drive",
        Real, float, double) {
        for (const bool falls : {false, true})
            for (const bool is_driven : {false, true}) {
                if (falls && is_driven) continue;  // it would press what lies on the floor
                Scene scene = everything(falls);
                scene.effects.sleep = falls;
                if (is_driven)
                    scene.add({.type = BodyType::kinematic_body,
                               .shape = Disc{1},
                               .position = {-3, 6},
                               .velocity = {3, 0},
                               .angular_velocity = 8,
                               .material = {.friction = 0.6, .restitution = 0.9}});
                BasicWorld<Real> world(scene, {.threads = 1, .effects = {.ledger = true}});
                const double scale = world.ledger().energy.total();
                EnergyByCause last = world.ledger().energy_by_cause;
                double restitution = -1e300, friction = -1e300, drag = -1e300;
                for (int i = 0; i < (falls ? 600 : 240); ++i) {
                    world.step(kStep);
                    const EnergyByCause now = world.ledger().energy_by_cause;
                    restitution = std::max(restitution, now.restitution - last.restitution);
                    friction = std::max(friction, now.friction - last.friction);
                    drag = std::max(drag, now.drag - last.drag);
                    last = now;
                }
                const std::string scene_is = falls ? "falling" : is_driven ? "driven" : "in a box";
                report(scene_is, ": most that a step gave, of the energy at the start: restitution ",
                       restitution / scale, ", friction ", friction / scale, ", drag ", drag / scale,
                       "; drive ", last.drive / scale, ", impacts ", world.profile().impacts);
                CAPTURE(scene_is);
                // Forces of contacts that come to rest push overlaps apart: that is not of impacts.
                const double most = falls ? 1e-4 : sizeof(Real) == sizeof(float) ? 1e-6 : 1e-13;
                CHECK(restitution <= most * scale);
                CHECK(friction <= most * scale);
                CHECK(drag <= 0);
                CHECK(last.restitution < -0.1 * scale);
                CHECK(last.friction < -0.001 * scale);
                if (is_driven) CHECK(last.drive > 0.01 * scale);
                check_books_close(world, scale, dynamic_mass(everything()));
            }
    }

    TEST_CASE_TEMPLATE("B31: what lies on each other in a crowd that bounces gives no energy in any step",
                       Real, float, double) {
        for (const bool has_obstacle : {false, true})
            for (const double e : {0.5, 0.9, 1.0})
                for (const double friction : {0.0, 0.3}) {
                    if (e == 1 && friction == 0) continue;  // comes to rest nowhere
                    if (is_effort_reduced() && has_obstacle != (friction > 0)) continue;
                    CAPTURE(has_obstacle);
                    CAPTURE(e);
                    CAPTURE(friction);
                    Scene scene = dropped(8, 12, e, friction);
                    scene.effects.ledger = true;
                    if (has_obstacle)
                        scene.add({.type = BodyType::static_body,
                                   .shape = Segment{{1, 3}, {4, 1}},
                                   .material = {.friction = friction, .restitution = e}});
                    BasicWorld<Real> world(scene, {.threads = 1});
                    const double scale = world.ledger().energy.total();
                    EnergyByCause last = world.ledger().energy_by_cause;
                    double restitution = -1e300, of_friction = -1e300, all = 0;
                    for (int i = 0; i < 900; ++i) {
                        world.step(kStep);
                        const EnergyByCause now = world.ledger().energy_by_cause;
                        restitution = std::max(restitution, now.restitution - last.restitution);
                        of_friction = std::max(of_friction, now.friction - last.friction);
                        all += std::max(0.0, now.restitution - last.restitution);
                        last = now;
                    }
                    report("e ", e, ", friction ", friction, has_obstacle ? ", obstacle" : "",
                           ": most that a step gave by restitution ", restitution / scale, ", all ",
                           all / scale, ", by friction ", of_friction / scale);
                    // Sweeps may leave a ten-thousandth of what gravity gives a body at rest in a substep.
                    CHECK(restitution <= 1e-8 * scale);
                    CHECK(of_friction <= 1e-8 * scale);
                    CHECK(last.restitution + last.friction < -0.01 * scale);
                    check_books_close(world, scale, dynamic_mass(scene));
                }
    }

    TEST_CASE_TEMPLATE("B31: a bouncing crowd keeps the energy rule and has the same bits on two threads",
                       Real, float, double) {
        for (const double restitution : {0.3, 0.9, 0.99})
            for (const double friction : {0.0, 0.5}) {
                if (is_effort_reduced() && (restitution == 0.9) != (friction > 0)) continue;
                CAPTURE(restitution);
                CAPTURE(friction);
                const Scene scene = dropped(10, 20, restitution, friction);
                BasicWorld<Real> world(scene, {.threads = 1}), again(scene, {.threads = 2});
                const double start = world.ledger().energy.total();
                bool keeps = true;
                for (int i = 0; i < 300; ++i) {
                    world.step(kStep), again.step(kStep);
                    keeps = keeps && torture::keeps_energy_rule(world.ledger().energy.total(), start);
                }
                CHECK(keeps);
                CHECK(world.quarantined().empty());
                CHECK(world.state_hash() == again.state_hash());
            }
    }

    TEST_CASE_TEMPLATE("B32: beside a pile that lies still an elastic gas keeps its energy", Real, float,
                       double) {
        // A column of static discs stands between them: what is elastic on its right, what rests on its left.
        for (const bool has_pile : {false, true}) {
            CAPTURE(has_pile);
            Scene scene;
            scene.accuracy.solver = Solver::soft;
            scene.gravity = {0, -9.81};
            scene.walls = Walls{.min = {-12, 0}, .max = {12, 20}, .material = bouncy(0)};
            for (int i = 0; i < 20; ++i)
                scene.add({.type = BodyType::static_body, .shape = Disc{0.5}, .position = {0, 0.5 + i}});
            Lattice lattice;
            lattice.count_x = 8, lattice.count_y = 8, lattice.origin = {1.5, 1.5},
            lattice.spacing = {1.3, 2.0};
            lattice.body.material = bouncy(1);
            lattice.jitter = 0.05, lattice.seed = 5, lattice.body.shape = Disc{0.4};
            add_lattice(scene, lattice);
            const std::size_t first = 20, last = scene.bodies.size();
            for (std::size_t i = first; i < last; ++i)
                scene.bodies[i].velocity = {3 * std::cos(2.0 * static_cast<double>(i)),
                                            3 * std::sin(2.0 * static_cast<double>(i))};
            lattice.count_x = 10, lattice.count_y = 7, lattice.origin = {-11.4, 0.51},
            lattice.spacing = {1.1, 1.01};
            lattice.body.material = {.friction = 0.5};
            lattice.body.shape = Disc{0.5};
            if (has_pile) add_lattice(scene, lattice);
            BasicWorld<Real> world(scene, {.threads = 1});
            const auto gas_energy = [&] {
                double sum = 0;
                for (std::uint32_t i = first; i < last; ++i) {
                    const BodyState s = world.state({i, 0});
                    sum += 0.5 * (s.velocity.x * s.velocity.x + s.velocity.y * s.velocity.y) +
                           9.81 * s.position.y;
                }
                return sum;
            };
            const double start = gas_energy();
            double off = 0;
            for (int i = 0; i < 1200; ++i) {
                world.step(kStep);
                off = std::max(off, std::abs(gas_energy() / start - 1));
            }
            double square = 0;
            for (std::size_t i = last; i < scene.bodies.size(); ++i) {
                const BodyState s = world.state({static_cast<std::uint32_t>(i), 0});
                square += s.velocity.x * s.velocity.x + s.velocity.y * s.velocity.y;
            }
            const double rms =
                has_pile ? std::sqrt(square / static_cast<double>(scene.bodies.size() - last)) : 0;
            report(has_pile ? "with" : "without", " a pile: gas energy off by ", off, ", pile's rms speed ",
                   rms, " m/s, impacts ", world.profile().impacts);
            CHECK(off < 5e-3);  // a pressed contact that is hit has no restitution, which is rare
            CHECK(rms < 1e-3);
        }
    }

    TEST_CASE_TEMPLATE("copies, and snapshots taken while bodies bounce, go on with the same bits", Real,
                       float, double) {
        BasicWorld<Real> world(everything(), {.threads = 1});
        for (int i = 0; i < 37; ++i) world.step(kStep);
        std::vector<std::byte> snapshot(world.state_bytes());
        world.save_state(snapshot);
        BasicWorld<Real> copy(world), restored(everything(), {.threads = 1});
        restored.restore_state(snapshot);
        for (int i = 0; i < 60; ++i) {
            world.step(kStep), copy.step(kStep), restored.step(kStep);
            REQUIRE(copy.state_hash() == world.state_hash());
            REQUIRE(restored.state_hash() == world.state_hash());
        }
        const std::uint64_t end = world.state_hash();
        world.restore_state(snapshot);
        for (int i = 0; i < 60; ++i) world.step(kStep);
        CHECK(world.state_hash() == end);
    }

    TEST_CASE_TEMPLATE("bodies may be added and removed among bodies that bounce", Real, float, double) {
        BasicWorld<Real> world(everything(false), {.threads = 1, .effects = {.ledger = true}});
        BasicWorld<Real> again(everything(false), {.threads = 2, .effects = {.ledger = true}});
        double restitution = -1e300, scale = world.ledger().energy.total();
        for (std::uint32_t i = 0; i < 240; ++i) {
            if (i % 3 == 0 && i / 3 < 50) world.remove({i / 3, 0}), again.remove({i / 3, 0});
            if (i % 4 == 1) {
                Body body = disc(0.3, 0.2, {2.0 + 0.04 * i, 14}, {0, -6}, 0.9);
                body.material.friction = 0.2;
                world.add(body), again.add(body);
            }
            const double before = world.ledger().energy_by_cause.restitution;
            world.step(kStep), again.step(kStep);
            restitution = std::max(restitution, world.ledger().energy_by_cause.restitution - before);
        }
        CHECK(restitution <= (sizeof(Real) == sizeof(float) ? 1e-6 : 1e-13) * scale);
        CHECK(world.state_hash() == again.state_hash());
        CHECK(world.quarantined().empty());
        check_books_close(world, 10 * scale, 100);
    }

    TEST_CASE_TEMPLATE("in mid-air a ball may go from impulse to soft and back, its parabolas unbroken", Real,
                       float, double) {
        // e = 1 and no floor within reach of a step but at an impact: heights depend on no solver.
        Scene scene;
        scene.gravity = {0, -10};
        scene.walls = floor_at(0, 1);
        scene.accuracy.solver = Solver::impulse;
        scene.add(disc(0.5, 1, {0, 5.5}, {1, 0}, 1));
        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
        const double tolerance = sizeof(Real) == sizeof(float) ? 1e-4 : 1e-11;
        for (int i = 1; i <= 600; ++i) {
            if (i % 7 == 0) world.set_solver((i / 7) % 2 == 1 ? Solver::soft : Solver::impulse);
            world.step(kStep);
            const double t = std::fmod(i * kStep + 1, 2.0) - 1;  // s, since it was highest: it falls for 1 s
            const BodyState s = world.state({0, 0});
            REQUIRE(std::abs(s.position.y - (5.5 - 5 * t * t)) < tolerance);
            REQUIRE(std::abs(s.position.x - i * kStep) < tolerance);
        }
        CHECK(world.profile().wall_impacts == 5);
        check_books_close(world, 55);
    }

    TEST_CASE_TEMPLATE("a sleeper that is hit wakes and leaves as the impact formula says", Real, float,
                       double) {
        Scene scene;
        scene.accuracy.solver = Solver::soft;
        scene.effects.sleep = true;
        scene.walls = Walls{.min = {-50, -50}, .max = {50, 50}};
        scene.add(disc(0.5, 2, {0, 0}, {}, 0.8));
        scene.add(disc(0.5, 1, {-20, 0}, {5, 0}, 0.8));
        BasicWorld<Real> world(scene, {.effects = {.ledger = true}});
        for (int i = 0; i < 180; ++i) world.step(kStep);
        REQUIRE(world.is_asleep({0, 0}));
        for (int i = 0; i < 80; ++i) world.step(kStep);
        CHECK_FALSE(world.is_asleep({0, 0}));
        const double small = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-13;
        CHECK(std::abs(world.state({0, 0}).velocity.x - 3) < 5 * small);   // (1 + e) 5 / 3
        CHECK(std::abs(world.state({1, 0}).velocity.x - -1) < 5 * small);  // 5 - 2 * 3
        CHECK(std::abs(world.ledger().energy_by_cause.restitution + 3) < 20 * small);
        check_books_close(world, 3);
    }
}

}  // namespace test_bouncing

// A19 of docs/exact-cases.md with rough discs. Coulomb friction takes energy in every impact, so there is no
// equilibrium of translation and rotation; what is known exactly is what the impacts of a gas that does not
// turn yet do, and what solver `event` makes of them later.
#include "support/books.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <carom/world.hpp>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_rough_gas {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kSpeed = 3;  // m/s, root mean square

Scene rough_gas(std::int64_t count, double friction, std::uint64_t seed, Solver solver) {
    Scene scene = gas_scene({.count = count, .packing_fraction = 0.2, .velocity_rms = kSpeed, .seed = seed});
    for (Body& body : scene.bodies) body.material.friction = friction;
    scene.accuracy.solver = solver;
    return scene;
}

/// A smooth one after a while: discs that start on a lattice meet their neighbours first, the fast ones
/// before the slow.
Scene flown_gas(std::int64_t count, std::uint64_t seed) {
    Scene scene = rough_gas(count, 0, seed, Solver::event);
    World64 world(scene, {.threads = 1});
    world.step(1);
    for (std::uint32_t i = 0; i < scene.bodies.size(); ++i) {
        const BodyState state = world.state({i, 0});
        scene.bodies[i].position = state.position, scene.bodies[i].velocity = state.velocity;
    }
    return scene;
}

/// What one impact of two equal elastic discs without spin does on average, in units of mass * speed².
struct MeanImpact {
    double turned = 0;  // gain of rotational energy
    double lost = 0;    // loss of energy
};

/// In a gas the relative speed v of impacts has the mean square 3 <v²> (its density goes as v² exp(-v²/..)),
/// and the angle of incidence the density cos(a) / 2. Impulses as in A13: j_n = m v cos a, and along the
/// surface m v sin a / 6, but at most mu j_n. One of them changes each spin's energy by j_t² / m.
MeanImpact mean_impact(double friction) {
    constexpr int kAngles = 20'000;
    MeanImpact mean;
    for (int i = 0; i < kAngles; ++i) {
        const double sine = (i + 0.5) / kAngles;  // uniform, as cos(a) da = d(sin a)
        const double normal = std::sqrt(1 - sine * sine), stuck = sine / 6;
        const double along = std::min(stuck, friction * normal);
        mean.turned += 2 * along * along / kAngles;
        // The impulse pushes against the surfaces' velocity, which it changes by 6 j / m: work is done by the
        // mean of before and after.
        mean.lost += along * (sine - 3 * along) / kAngles;
    }
    mean.turned *= 3, mean.lost *= 3;
    return mean;
}

}  // namespace

TEST_SUITE("physics/rough gas") {
    TEST_CASE("A19, rough discs: the first impacts turn and take what kinetic theory says") {
        const int kStarts = scaled(20, 4), kCount = 20'000;
        constexpr double kFrictions[] = {0.05, 0.3};
        double turned[2] = {}, lost[2] = {}, impacts[2] = {};
        for (int start = 1; start <= kStarts; ++start) {
            Scene scene = flown_gas(kCount, static_cast<std::uint64_t>(start));
            for (int k = 0; k < 2; ++k) {
                for (Body& body : scene.bodies) body.material.friction = kFrictions[k];
                World64 world(scene, {.threads = 1});
                const double before = world.ledger().energy.total();
                double count = 0;
                while (count < 0.04 * kCount) {  // a disc in twelve: next to none meets two
                    world.step(0.002);
                    count = static_cast<double>(world.profile().impacts - world.profile().wall_impacts);
                }
                const Energy now = world.ledger().energy;
                turned[k] += now.rotational, lost[k] += before - now.total(), impacts[k] += count;
            }
        }
        for (int k = 0; k < 2; ++k) {
            const MeanImpact exact = mean_impact(kFrictions[k]);
            const double unit = 0.25 * std::numbers::pi * kSpeed * kSpeed * impacts[k];  // of 1 kg/m², J
            const double turned_ratio = turned[k] / unit / exact.turned,
                         lost_ratio = lost[k] / unit / exact.lost;
            report("friction ", kFrictions[k], ": turned ", turned_ratio, ", lost ", lost_ratio,
                   " of the exact value, ", impacts[k], " impacts");
            CAPTURE(kFrictions[k]);
            CHECK(std::fabs(turned_ratio - 1) < scaled(0.04, 0.08));
            CHECK(std::fabs(lost_ratio - 1) < scaled(0.04, 0.08));
        }
    }

    TEST_CASE("A19, rough discs: on a short horizon impulse makes the same impacts as event, to round-off") {
        constexpr double kTime = 0.5;  // s: one to two collisions a disc
        const auto scene_for = [](Solver solver) {
            Scene scene = gas_scene({.count = 500, .packing_fraction = 0.3, .smallest_radius = 0.3});
            scene.walls->material.friction = 0.4;
            for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
                scene.bodies[i].material.friction = 0.1 * static_cast<double>(i % 5);
                scene.bodies[i].fixed_rotation = i % 9 == 0;
            }
            scene.accuracy.solver = solver;
            return scene;
        };
        World64 exact(scene_for(Solver::event));
        exact.step(kTime);
        REQUIRE(exact.profile().impacts > 250);
        for (const int steps : {4, 30, 240}) {
            CAPTURE(steps);
            World64 stepped(scene_for(Solver::impulse), {.threads = 1});
            for (int i = 0; i < steps; ++i) stepped.step(kTime / steps);
            CHECK(stepped.profile().impacts == exact.profile().impacts);
            double farthest = 0, turned = 0;
            for (std::uint32_t i = 0; i < exact.body_count(); ++i) {
                const BodyState p = exact.state({i, 0}), q = stepped.state({i, 0});
                farthest =
                    std::max(farthest, std::hypot(p.position.x - q.position.x, p.position.y - q.position.y));
                turned = std::max(turned, std::fabs(p.angle - q.angle));
            }
            report(steps, " steps: farthest apart ", farthest, " m, ", turned, " rad");
            CHECK(farthest < 1e-9);
            CHECK(turned < 1e-8);
        }
    }

    TEST_CASE(
        "A19, rough discs: on a long horizon impulse has the collision rate, energy and spins of event") {
        const int kStarts = scaled(4, 2);
        double impacts[2] = {}, energy[2] = {}, rotational[2] = {};
        for (int start = 1; start <= kStarts; ++start)
            for (const Solver solver : {Solver::impulse, Solver::event}) {
                World64 world(rough_gas(1000, 0.3, static_cast<std::uint64_t>(start), solver),
                              {.threads = 1});
                const std::size_t k = solver == Solver::event;
                for (int i = 0; i < 600; ++i) {
                    world.step(1.0 / 60);
                    // Sums over time, since the share of rotation fluctuates by 5 % at any moment.
                    energy[k] += world.ledger().energy.total();
                    rotational[k] += world.ledger().energy.rotational;
                }
                impacts[k] += static_cast<double>(world.profile().impacts);
            }
        report("impulse over event: impacts ", impacts[0] / impacts[1], " of ", impacts[1], ", energy ",
               energy[0] / energy[1], ", rotational ", rotational[0] / rotational[1]);
        CHECK(std::fabs(impacts[0] / impacts[1] - 1) < 0.01);
        CHECK(std::fabs(energy[0] / energy[1] - 1) < 0.02);
        CHECK(std::fabs(rotational[0] / rotational[1] - 1) < 0.03);
    }

    TEST_CASE_TEMPLATE(
        "A19, rough discs: under impulse a gas without walls keeps momentum and angular "
        "momentum, and its books close",
        Real, float, double) {
        constexpr double kSmall = sizeof(Real) == sizeof(float) ? 2e-6 : 1e-14;
        Scene scene = rough_gas(1000, 0.3, 2, Solver::impulse);
        scene.walls.reset();
        for (std::size_t i = 0; i < scene.bodies.size(); ++i)
            scene.bodies[i].angular_velocity = 0.5 * static_cast<double>(i % 11);
        BasicWorld<Real> world(scene, {.threads = 1, .effects = {.ledger = true}});
        const Ledger before = world.ledger();
        for (int i = 0; i < 120; ++i) world.step(1.0 / 60);
        const Ledger after = world.ledger();
        REQUIRE(world.profile().impacts > 1000);
        const double mass = 1000 * std::numbers::pi / 4, size = 40;  // kg, m
        const double momentum =
            std::hypot(after.momentum.x - before.momentum.x, after.momentum.y - before.momentum.y) /
            (mass * kSpeed);
        const double angular =
            std::fabs(after.angular_momentum - before.angular_momentum) / (mass * kSpeed * size);
        report("momentum ", momentum, ", angular momentum ", angular, " of all that there is");
        CHECK(momentum < kSmall);
        CHECK(angular < kSmall);
        CHECK(after.energy_by_cause.friction < -100);
        check_books_close(world, mass);
    }

    TEST_CASE_TEMPLATE("A19, rough discs: solver soft cools and turns a gas as solver event does", Real,
                       float, double) {
        const int kCount = scaled(20'000, 4000);  // the share fluctuates by 5 % with 4,000 discs
        constexpr double kStep = 1.0 / 60;
        for (const double friction : scaled<std::vector<double>>({0.05, 0.3}, {0.3})) {
            const Scene soft_scene = rough_gas(kCount, friction, 5, Solver::soft);
            BasicWorld<Real> soft(soft_scene, {.threads = 1});
            World64 event(rough_gas(kCount, friction, 5, Solver::event), {.threads = 1});
            for (int second = 1; second <= 12; ++second) {
                for (int i = 0; i < 60; ++i) soft.step(kStep);
                event.step(1);
                if (second % 4 != 0) continue;
                const Energy of_soft = soft.ledger().energy, of_event = event.ledger().energy;
                const double energy = of_soft.total() / of_event.total();
                const double share =
                    (of_soft.rotational / of_soft.kinetic) / (of_event.rotational / of_event.kinetic);
                report("friction ", friction, ", ", second, " s: energy ", energy,
                       ", rotation over translation ", share, " of that of event");
                CAPTURE(friction);
                CHECK(std::fabs(energy - 1) < scaled(0.04, 0.08));
                CHECK(std::fabs(share - 1) < scaled(0.08, 0.16));
            }
        }
    }
}

}  // namespace test_rough_gas

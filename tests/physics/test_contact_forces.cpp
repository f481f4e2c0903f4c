// What contacts of solver `soft` carry (A26 of docs/exact-cases.md), and how well they are solved: read
// inside the solver.
#include "shapes/walls.hpp"
#include "solvers/soft/soft_simulation.hpp"
#include "support/inside.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <map>
#include <vector>

namespace test_contact_forces {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5, kGravity = 10;

/// The contacts of a world under solver `soft`, from inside.
template <class Real>
struct Forces {
    std::unique_ptr<Simulation<Real>> simulation;
    SoftSimulation<Real>& sim = static_cast<SoftSimulation<Real>&>(*simulation);

    explicit Forces(const Scene& scene) : simulation(inside_of<Real>(scene, Solver::soft)) {}
    void run(int steps) {
        for (int i = 0; i < steps; ++i) sim.step(kStep);
    }
    /// N, between rows a and b; 0 if they do not touch.
    double force(std::int32_t a, std::int32_t b) const {
        double impulse = 0;
        sim.soft.graph.pairs.for_each([&](std::size_t i) {
            const auto& pairs = sim.soft.graph.pairs;
            if ((pairs.a[i] == a && pairs.b[i] == b) || (pairs.a[i] == b && pairs.b[i] == a))
                impulse = static_cast<double>(pairs.normal_impulse[i]);
        });
        return impulse / sim.substep_dt;
    }
    /// N, that the floor holds up.
    double floor_force() const {
        double impulse = 0;
        sim.soft.graph.supports.for_each([&](std::size_t i) {
            if (sim.soft.graph.supports.b[i] == kBottom)
                impulse += static_cast<double>(sim.soft.graph.supports.normal_impulse[i]);
        });
        return impulse / sim.substep_dt;
    }
};

/// Discs on top of each other in a shaft; rows keep their order, being few.
Scene stack_of(const std::vector<double>& masses) {
    Scene scene;
    scene.gravity = {0, -kGravity};
    scene.walls = Walls{.min = {-1.001 * kRadius, 0}, .max = {1.001 * kRadius, 1000}, .top = false};
    scene.accuracy.solver = Solver::soft;
    for (std::size_t i = 0; i < masses.size(); ++i)
        scene.add(disc(kRadius, masses[i], {0, kRadius * (1 + 2 * static_cast<double>(i))}));
    return scene;
}

}  // namespace

TEST_SUITE("physics/contact forces") {
    TEST_CASE_TEMPLATE("A26: each contact of a stack carries the weight of what is above it", Real, float,
                       double) {
        std::vector<double> equal(10, 2.0), growing, doubling;
        for (int i = 0; i < 10; ++i) growing.push_back(i + 1), doubling.push_back(std::ldexp(1, i));
        for (const auto& masses : {equal, growing, doubling}) {
            Forces<Real> inside(stack_of(masses));
            inside.run(3600);
            double above = 0, worst = 0;
            for (std::size_t upper = masses.size(); upper-- > 0;) {
                above += masses[upper];
                const auto row = static_cast<std::int32_t>(upper);
                const double force = upper > 0 ? inside.force(row - 1, row) : inside.floor_force();
                worst = std::fmax(worst, std::fabs(force / (above * kGravity) - 1));
            }
            const double top = static_cast<double>(inside.sim.world.bodies.position_y[masses.size() - 1]);
            const double sink = kRadius * (2 * static_cast<double>(masses.size()) - 1) - top;
            report("masses 1 to ", masses.back() / masses.front(), ": largest relative error of a force ",
                   worst, ", sink ", sink, " m");
            // Loads of a thousand times what is below them settle slowly: after a minute they are known to
            // 1e-3.
            const double settled = sizeof(Real) == 4 ? 1e-4 : 1e-9;
            CHECK(worst < (masses == doubling ? 1e-3 : settled));
            CHECK(std::fabs(sink) < (masses == doubling ? 0.05 : settled));
        }
    }

    TEST_CASE_TEMPLATE("the residual is what another sweep would change", Real, float, double) {
        // A disc that lands: nothing is solved yet but its own contact, which one sweep solves.
        Forces<Real> one(stack_of({1}));
        one.run(1);
        CHECK(one.sim.soft.quality().touching == 1);
        CHECK(one.sim.soft.quality().residual < 1e-6);
        // A heavy one on a light one: sweeps take the light one's share of what is left, so much is left.
        // (Beyond a ratio of ten they are solved on their own.)
        Forces<Real> two(stack_of({1, 10}));
        two.run(1);
        const SolveQuality early = two.sim.soft.quality();
        CHECK(early.touching == 2);
        const double down = -static_cast<double>(two.sim.world.bodies.velocity_y[1]);
        report("speed ", down, " m/s, residual ", early.residual, ", largest ", early.residual_max);
        CHECK(early.residual_max == doctest::Approx(down).epsilon(0.01));  // the light one stands
        CHECK(early.residual <= early.residual_max);
        CHECK(early.residual >= early.residual_max / std::sqrt(2) * 0.999);
        two.run(6000);
        CHECK(two.sim.soft.quality().residual < 1e-2 * early.residual);
    }

    // What is left from an earlier touch would be given to the bodies when they touch again.
    TEST_CASE_TEMPLATE("a contact that does not push neither rubs nor resists rolling", Real, float, double) {
        Scene scene;
        scene.gravity = {1, -kGravity};
        const Material rough{.friction = 0.5, .rolling_resistance = 0.1};
        for (int i = 0; i < 6; ++i)
            scene.add(
                {.shape = Disc{kRadius}, .position = {0.3 + 1.1 * i, 3.0 + 0.2 * i}, .material = rough});
        scene.add({.type = BodyType::static_body, .shape = Disc{1}, .position = {3, 1}, .material = rough});
        Chain slope;  // discs roll from one of its edges to the next
        for (int i = 0; i < 40; ++i) slope.points.push_back({-4 + 0.7 * i, 1 - 0.1 * i});
        scene.add({.type = BodyType::static_body, .shape = slope, .material = rough});
        scene.accuracy.solver = Solver::soft;
        Forces<Real> inside(scene);
        std::size_t pushed = 0, idle = 0, wrong = 0;
        for (int i = 0; i < 150; ++i) {
            inside.run(1);
            const auto& graph = inside.sim.soft.graph;
            for (const ContactRows<Real>* contacts : {&graph.pairs, &graph.supports})
                contacts->for_each([&](std::size_t k) {
                    const bool pushes = contacts->normal_impulse[k] > 0;
                    ++(pushes ? pushed : idle);
                    wrong +=
                        !pushes && (contacts->friction_impulse[k] != 0 || contacts->rolling_impulse[k] != 0);
                });
        }
        CHECK(pushed > 50);
        CHECK(idle > 50);
        CHECK(wrong == 0);
    }
}

}  // namespace test_contact_forces

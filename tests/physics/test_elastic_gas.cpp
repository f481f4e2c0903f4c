// A19 of docs/exact-cases.md: an elastic gas keeps its energy, the walls account for its momentum, and its
// speeds take Maxwell's distribution.
#include "support/books.hpp"
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <cmath>

namespace test_elastic_gas {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60;

/// Mean of v⁴ over the squared mean of v²: 2 for Maxwell's distribution in the plane, 1 if all speeds are
/// equal.
template <class Real>
double flatness(const BasicWorld<Real>& world) {
    const BodyView<Real> bodies = world.bodies();
    double squares = 0, fourths = 0;
    for (std::size_t row = 0; row < bodies.count; ++row) {
        const double vx = bodies.velocity_x[row], vy = bodies.velocity_y[row], v2 = vx * vx + vy * vy;
        squares += v2, fourths += v2 * v2;
    }
    return fourths * static_cast<double>(bodies.count) / (squares * squares);
}

/// All speeds of the scene made equal, directions kept.
void make_speeds_equal(Scene& scene, double speed) {
    for (Body& body : scene.bodies) {
        const double scale = speed / std::hypot(body.velocity.x, body.velocity.y);
        body.velocity = {scale * body.velocity.x, scale * body.velocity.y};
    }
}

}  // namespace

TEST_SUITE("physics/elastic gas") {
    TEST_CASE_TEMPLATE("a gas of 10,000 discs keeps its energy over 600 steps of 1/60 s", Real, float,
                       double) {
        constexpr bool kFloat = sizeof(Real) == sizeof(float);
        const Scene scene = gas_scene({.count = scaled(10000, 800)});
        BasicWorld<Real> world(scene, {.solver = Solver::impulse, .threads = 1, .effects = {.ledger = true}});
        const double start = world.ledger().energy.total();
        for (int i = 0; i < 600; ++i) world.step(kStep);
        const double change = world.ledger().energy.total() / start - 1;
        report("relative change of energy ", change, ", unexplained momentum ",
               world.ledger().momentum_by_cause.unexplained.x, " kg m/s, ", world.profile().impacts,
               " impacts");
        CHECK(std::abs(change) < (kFloat ? 1e-5 : 1e-12));
        CHECK(world.profile().unresolved_impacts == 0);
        CHECK(world.quarantined().empty());
        CHECK(world.overlaps().max < 1e-3);
        check_books_close(world, dynamic_mass(scene));
    }

    TEST_CASE_TEMPLATE("a gas without walls keeps its momentum and its angular momentum", Real, float,
                       double) {
        constexpr double kTolerance = sizeof(Real) == sizeof(float) ? 1e-6 : 1e-14;
        Scene scene = gas_scene({.count = 500, .packing_fraction = 0.5});
        scene.walls.reset();
        for (Body& body : scene.bodies) body.velocity.x += 1;
        BasicWorld<Real> world(scene, {.solver = Solver::impulse, .threads = 1, .effects = {.ledger = true}});
        const Ledger before = world.ledger();
        for (int i = 0; i < 120; ++i) world.step(kStep);
        const Ledger after = world.ledger();
        REQUIRE(world.profile().impacts > 1000);
        const double momentum = dynamic_mass(scene) * 3;  // kg m/s
        CHECK(std::abs(after.momentum.x - before.momentum.x) < kTolerance * momentum);
        CHECK(std::abs(after.momentum.y - before.momentum.y) < kTolerance * momentum);
        CHECK(std::abs(after.angular_momentum - before.angular_momentum) < kTolerance * momentum * 20);
        check_books_close(world, dynamic_mass(scene));
    }

    TEST_CASE_TEMPLATE("speeds that were all equal take Maxwell's distribution", Real, float, double) {
        const std::int64_t count = scaled(10000, 2000);
        Scene scene = gas_scene({.count = count});
        make_speeds_equal(scene, 3);
        BasicWorld<Real> world(scene, {.solver = Solver::impulse, .threads = 1});
        CHECK(flatness(world) == doctest::Approx(1).epsilon(1e-6));
        for (int i = 0; i < 300; ++i) world.step(kStep);  // some 45 collisions a disc
        double mean = 0;
        const int kSamples = scaled(60, 20);
        for (int sample = 0; sample < kSamples; ++sample) {
            for (int i = 0; i < 20; ++i) world.step(kStep);  // some 3
            mean += flatness(world) / kSamples;
        }
        // For n discs one sample is off by 2 / √n; three samples in a row count for one that is independent.
        const double deviation = 2 / std::sqrt(static_cast<double>(count * kSamples) / 3);
        report("flatness ", mean, ", expected 2 within ", deviation);
        CHECK(std::abs(mean - 2) < 3 * deviation);
    }
}

}  // namespace test_elastic_gas

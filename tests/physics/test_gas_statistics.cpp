// A20 of docs/exact-cases.md: pressure and collision rate of hard discs at steps of 1/60 s. These are what an
// engine gets wrong that lets discs overlap before it reacts, while its energy looks perfect.
//
// Pressure: Henderson's equation of state (Henderson 1975), good to 0.2 % below a packing fraction of 0.3.
// Rate: kinetic theory with the contact value of Verlet and Levesque (1982).
// Both are about the bulk. Walls draw discs to themselves, so the bulk's density is measured away from them,
// and the pressure acts on the length that centres can reach: exact without interaction, and off by less than
// a radius over the box's width with it.
#include "support/effort.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"

#include <doctest/doctest.h>
#include <carom/world.hpp>

#include <cmath>
#include <numbers>

namespace test_gas_statistics {

using namespace carom;
using namespace carom::test;

namespace {

constexpr double kStep = 1.0 / 60, kRadius = 0.5, kDiameter = 2 * kRadius;
constexpr double kAwayFromWalls = 8 * kDiameter;

struct Bulk {
    double pressure_error = 0;  // relative
    double rate_error = 0;      // relative
    double packing_fraction = 0;
    std::int64_t impacts = 0;
};

double compressibility(double eta) {
    return (1 + eta * eta / 8) / ((1 - eta) * (1 - eta));
}

/// Collisions of one disc a second.
double collision_rate(double eta, double temperature_over_mass) {
    const double density = eta / (std::numbers::pi * kRadius * kRadius);
    const double contact_value = (1 - 7 * eta / 16) / ((1 - eta) * (1 - eta));
    return 2 * density * kDiameter * contact_value * std::sqrt(std::numbers::pi * temperature_over_mass);
}

/// Discs a square metre, away from the walls.
template <class Real>
double inner_density(const BasicWorld<Real>& world, double half) {
    const double inside = half - kAwayFromWalls;
    const BodyView<Real> bodies = world.bodies();
    std::int64_t count = 0;
    for (std::size_t row = 0; row < bodies.count; ++row)
        count += std::abs(static_cast<double>(bodies.position_x[row])) < inside &&
                 std::abs(static_cast<double>(bodies.position_y[row])) < inside;
    return static_cast<double>(count) / (4 * inside * inside);
}

/// Sum of m x·v about the middle of the box [J s].
template <class Real>
double virial(const BasicWorld<Real>& world, double mass) {
    const BodyView<Real> bodies = world.bodies();
    double sum = 0;
    for (std::size_t row = 0; row < bodies.count; ++row)
        sum += static_cast<double>(bodies.position_x[row]) * static_cast<double>(bodies.velocity_x[row]) +
               static_cast<double>(bodies.position_y[row]) * static_cast<double>(bodies.velocity_y[row]);
    return mass * sum;
}

template <class Real>
std::int64_t pair_impacts(const BasicWorld<Real>& world) {
    const Profile profile = world.profile();
    return profile.impacts - profile.wall_impacts;
}

template <class Real>
Bulk measure(std::int64_t count, double packing_fraction, double seconds, Solver solver = Solver::impulse,
             bool in_whole_box = false) {
    Scene scene = gas_scene({.count = count, .packing_fraction = packing_fraction, .velocity_rms = 3});
    scene.accuracy.solver = solver;
    BasicWorld<Real> world(scene, {.threads = 1});
    const auto run = [&](double duration) {
        const double step = solver == Solver::event ? 0.25 : kStep;  // which it does not depend on
        for (std::int64_t i = std::llround(duration / step); i > 0; --i) world.step(step);
    };
    run(4);
    const double n = static_cast<double>(count), half = scene.walls->max.x, reach = half - kRadius;
    const double mass = std::numbers::pi * kRadius * kRadius;
    const double temperature = world.ledger().energy.kinetic / n;  // k T, in the plane
    const double started = world.time();
    const double impulse = world.ledger().wall_impulse, virial_before = virial(world, mass);
    const std::int64_t impacts = pair_impacts(world);

    double density = 0;
    const int samples = static_cast<int>(std::lround(4 * seconds));
    for (int i = 0; i < samples; ++i) {
        run(0.25);
        density += inner_density(world, half) / samples;
    }
    // The density inside fluctuates; all discs' does not, and how walls change it goes with them.
    if (in_whole_box) density = n / (4 * half * half);
    Bulk bulk;
    bulk.packing_fraction = density * std::numbers::pi * kRadius * kRadius;
    const double time = world.time() - started;
    const double sloshing = (virial(world, mass) - virial_before) / reach;
    const double pressure = (world.ledger().wall_impulse - impulse + sloshing) / (8 * reach * time);
    bulk.pressure_error = pressure / (density * temperature * compressibility(bulk.packing_fraction)) - 1;
    bulk.impacts = pair_impacts(world) - impacts;
    const double rate = 2 * static_cast<double>(bulk.impacts) / (n * time);
    bulk.rate_error = rate / collision_rate(bulk.packing_fraction, temperature / mass) - 1;
    CHECK(world.profile().unresolved_impacts == 0);
    return bulk;
}

}  // namespace

TEST_SUITE("physics/gas statistics") {
    TEST_CASE(
        "pressure and collision rate are right within 0.5 % with solver event, walls put out of account") {
        // Discs near walls meet fewer others: an error that halves with twice the side, so two boxes, of
        // 2,000 and of four times as many discs, tell what a gas without walls has.
        const std::int64_t count = scaled(2000, 500);
        const double tolerance = scaled(0.005, 0.05);
        for (const double eta : {0.1, 0.2, 0.3}) {
            CAPTURE(eta);
            const Bulk small = measure<double>(count, eta, scaled(50 / eta, 40.0), Solver::event, true);
            const Bulk large = measure<double>(4 * count, eta, scaled(25 / eta, 40.0), Solver::event, true);
            const double pressure_error = 2 * large.pressure_error - small.pressure_error;
            const double rate_error = 2 * large.rate_error - small.rate_error;
            report("event, packing fraction ", eta, ": pressure ", 100 * pressure_error, " %, rate ",
                   100 * rate_error, " %; in the smaller box ", 100 * small.pressure_error, " % and ",
                   100 * small.rate_error, " %");
            CHECK(std::abs(pressure_error) < tolerance);
            CHECK(std::abs(rate_error) < tolerance);
        }
    }

    TEST_CASE_TEMPLATE("pressure and collision rate of a gas are right within 1 % at steps of 1/60 s", Real,
                       float, double) {
        // A slow build looks at fewer discs, where walls and chance matter more: it checks that the code
        // works.
        const std::int64_t count = scaled(40000, 2500);
        const double tolerance = scaled(0.01, 0.05);
        for (const double eta : {0.1, 0.2, 0.3}) {
            CAPTURE(eta);
            const Bulk bulk = measure<Real>(count, eta, scaled(10.0, 5.0));
            report("packing fraction ", eta, " (inside ", bulk.packing_fraction, "): pressure ",
                   100 * bulk.pressure_error, " %, rate ", 100 * bulk.rate_error, " %, ", bulk.impacts,
                   " impacts");
            CHECK(std::abs(bulk.pressure_error) < tolerance);
            CHECK(std::abs(bulk.rate_error) < tolerance);
        }
    }
}

}  // namespace test_gas_statistics

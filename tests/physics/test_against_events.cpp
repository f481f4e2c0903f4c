// The engine against the oracle of tests/support: the same impacts at the same times, so the same motion to
// round-off, at every step length. Round-off grows with every collision, by the same factor as any small
// error: how much it may have grown is measured on the oracle.
#include "support/event_simulation.hpp"
#include "support/report.hpp"
#include "support/scenes.hpp"
#include "support/trial.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

namespace test_against_events {

using namespace carom;
using namespace carom::test;

namespace {

/// Largest distance between a disc and where the oracle has it [m].
template <class Real>
double largest_distance(const Trial<Real>& trial, const EventSimulation& oracle) {
    long double largest = 0;
    for (std::size_t i = 0; i < oracle.discs.size(); ++i) {
        const BodyState state = trial.state(static_cast<std::uint32_t>(i));
        largest = std::max({largest, std::abs(state.position.x - oracle.discs[i].x),
                            std::abs(state.position.y - oracle.discs[i].y)});
    }
    return static_cast<double>(largest);
}

/// How much an error in the starting positions has grown by the end, at most over some perturbed oracles.
double growth_of_errors(const Scene& scene, const EventSimulation& exact, long double seconds) {
    constexpr long double kError = 1e-13L;  // m
    long double largest = 0;
    for (std::uint64_t trial = 1; trial <= 8; ++trial) {
        EventSimulation perturbed(scene);
        std::uint64_t bits = trial * 0x9E3779B97F4A7C15u;
        for (EventSimulation::Disc& disc : perturbed.discs) {
            disc.x += (bits & 1u) != 0 ? kError : -kError;
            disc.y += (bits & 2u) != 0 ? kError : -kError;
            bits = bits >> 2 | bits << 62;
        }
        perturbed.run_until(seconds);
        for (std::size_t i = 0; i < exact.discs.size(); ++i)
            largest = std::max({largest, std::abs(perturbed.discs[i].x - exact.discs[i].x),
                                std::abs(perturbed.discs[i].y - exact.discs[i].y)});
    }
    return static_cast<double>(largest / kError);
}

template <class Real>
void check_against_oracle(const Scene& scene, double seconds) {
    constexpr double kSize = 8;  // m, coordinates of the scene are smaller
    for (const double dt : {0.5, 0.1, 1.0 / 60, 1.0 / 500}) {
        CAPTURE(dt);
        Trial<Real> trial(scene, {.solver = Solver::impulse});
        const int steps = static_cast<int>(std::lround(seconds / dt));
        trial.run(steps, dt);
        EventSimulation oracle(scene, rounded_to<Real>);
        oracle.run_until(static_cast<long double>(steps) * dt);
        EventSimulation unrounded(scene);
        unrounded.run_until(static_cast<long double>(steps) * dt);
        const double growth = growth_of_errors(scene, unrounded, static_cast<long double>(steps) * dt);
        const double tolerance = 4 * growth * kRounding<Real> * kSize * std::sqrt(steps + 10.0);
        CAPTURE(growth);
        REQUIRE(tolerance < 0.1);  // else the comparison means nothing
        const double distance = largest_distance(trial, oracle);
        CHECK(distance <= tolerance);
        const Profile profile = trial.world.profile();
        CHECK(profile.impacts - profile.wall_impacts == oracle.pair_impacts);
        CHECK(profile.wall_impacts == oracle.wall_impacts);
        const auto impulse = static_cast<double>(oracle.wall_impulse);
        CHECK(std::abs(trial.world.ledger().wall_impulse - impulse) <= tolerance * impulse);
        trial.check();
        if (dt == 0.1)
            report(oracle.pair_impacts + oracle.wall_impacts, " impacts, errors grown by ", growth,
                   ", largest distance ", distance, " m, allowed ", tolerance, " m");
    }
}

Scene mixed_discs(double restitution) {
    Scene scene = gas_scene({.count = 30,
                             .packing_fraction = 0.2,
                             .restitution = restitution,
                             .smallest_radius = 0.1,
                             .largest_radius = 0.6,
                             .seed = 5});
    double mass = 0.3;
    for (Body& body : scene.bodies) body.mass = mass, mass *= 1.07;
    return scene;
}

}  // namespace

TEST_SUITE("physics/against events") {
    TEST_CASE("a gas of unlike discs moves as the event-driven oracle says, at every step length") {
        check_against_oracle<double>(mixed_discs(1), 2);
        check_against_oracle<float>(mixed_discs(1), 0.5);
    }

    TEST_CASE("an inelastic gas moves as the event-driven oracle says, at every step length") {
        check_against_oracle<double>(mixed_discs(0.7), 2);
        check_against_oracle<float>(mixed_discs(0.7), 0.5);
    }

    TEST_CASE(
        "bouncing discs under slanted gravity move as the event-driven oracle says, at every step length") {
        Scene scene = mixed_discs(0.95);
        scene.gravity = {1.5, -6};
        check_against_oracle<double>(scene, 1);
        check_against_oracle<float>(scene, 0.5);
    }
}

}  // namespace test_against_events

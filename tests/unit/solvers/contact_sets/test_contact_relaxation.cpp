// Contacts relaxed for the velocities of bodies: against statics, momentum and the energy rule.
#include "solvers/contact_sets/contact_relaxation.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "math/random.hpp"

namespace test_contact_relaxation {

using namespace carom;

namespace {

constexpr double kFall = 0.04;  // m/s, what gravity adds in a substep of 1/240 s

LocalContact contact_of(std::int32_t a, std::int32_t b, double nx, double ny, double friction) {
    LocalContact contact{};
    contact.a = a, contact.b = b;
    contact.terms.nx = nx, contact.terms.ny = ny, contact.terms.friction = friction;
    contact.terms.of_a = 0.5;
    return contact;
}

/// Bodies and their contacts through substeps under gravity.
template <int kSize>
struct System {
    using Velocity = typename ContactRelaxation<kSize>::Velocity;
    std::vector<double> mass;  // kg
    std::vector<Velocity> velocity;
    std::vector<LocalContact> contacts;
    ContactRelaxation<kSize> relaxation;

    explicit System(std::vector<double> masses) : mass(std::move(masses)), velocity(mass.size()) {}

    /// @param gravity  m/s, what it adds in a substep
    void step(double gravity) {
        relaxation.begin(contacts, mass.size());
        for (std::size_t i = 0; i < mass.size(); ++i) {
            Velocity free = velocity[i];
            free[1] -= gravity;
            relaxation.set_body(i, 1 / mass[i], velocity[i], free, free);
        }
        relaxation.solve(contacts, kFall, {.rounds = 2, .accuracy = 0.1, .slack = 10});
        for (std::size_t i = 0; i < mass.size(); ++i) velocity[i] = relaxation.velocity(i);
    }
    double kinetic_energy() const {
        double sum = 0;
        for (std::size_t i = 0; i < mass.size(); ++i)
            for (std::size_t k = 0; k < kSize; ++k)
                sum += 0.5 * (k < 2 ? 1 : 0.5) * mass[i] * velocity[i][k] * velocity[i][k];
        return sum;
    }
};

}  // namespace

TEST_SUITE("solvers/contact_sets/contact_relaxation") {
    TEST_CASE_TEMPLATE("a column of light and heavy bodies comes to carry its weight", Size,
                       std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
        for (const double ratio : {1.0, 1e3, 1e6}) {
            CAPTURE(ratio);
            System<Size::value> column({1, ratio, 1, 1, ratio, ratio, 1});
            // The normal leads from a to b: the ground, which is no body, is below the lowest one.
            column.contacts.push_back(contact_of(0, -1, 0, -1, 0.5));
            for (std::int32_t i = 0; i + 1 < 7; ++i)
                column.contacts.push_back(contact_of(i, i + 1, 0, 1, 0.5));
            for (int substep = 0; substep < 400; ++substep) column.step(kFall);
            double above = 0;
            for (std::size_t i = column.mass.size(); i-- > 0;) {
                above += column.mass[i];
                // A body is left where it is off by less than a tenth of what gravity adds.
                CHECK(column.contacts[i].impulses.normal == doctest::Approx(above * kFall).epsilon(0.1));
                CHECK(std::fabs(column.velocity[i][1]) < 0.1 * kFall);
            }
        }
    }
    TEST_CASE("a light body that meets a heavy one is stopped, by its momentum") {
        System<2> system({1, 1e6});
        system.velocity[0] = {3, 0};
        system.contacts.push_back(contact_of(0, 1, 1, 0, 0));
        system.step(0);
        CHECK(std::fabs(system.velocity[0][0] - system.velocity[1][0]) < 0.1 * kFall);
        // The heavy one, 3e-6 m/s off, is left where it is: decision 0032 says what became of momentum.
        CHECK(std::fabs(system.velocity[1][0]) < 0.1 * kFall);
        CHECK(system.contacts[0].impulses.normal == doctest::Approx(3).epsilon(1e-3));
    }
    TEST_CASE_TEMPLATE("whatever impulses it begins with, it adds no energy but the slack", Size,
                       std::integral_constant<int, 2>, std::integral_constant<int, 3>) {
        Random random(11);
        const auto draw = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random.next() % 100'001) * 1e-5;
        };
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> mass;
            for (int i = 0; i < 12; ++i) mass.push_back(std::pow(10, draw(0, 6)));
            System<Size::value> system(mass);
            for (auto& velocity : system.velocity)
                for (double& part : velocity) part = draw(-1, 1);
            double slack = 0;  // J: 10 m (what gravity adds)², contact_relaxation.cpp
            for (const double m : mass) slack += 10 * m * kFall * kFall;
            for (int i = 0; i < 24; ++i) {
                const auto a = static_cast<std::int32_t>(random.next() % 12),
                           b = static_cast<std::int32_t>(random.next() % 13) - 1;
                if (a == b) continue;
                const double angle = draw(0, 6.3);
                system.contacts.push_back(contact_of(a, b, std::cos(angle), std::sin(angle), draw(0, 1)));
                system.contacts.back().impulses.normal = std::pow(10, draw(-3, 7));
            }
            const double before = system.kinetic_energy();
            system.step(0);
            REQUIRE(system.kinetic_energy() <= (before + slack) * (1 + 1e-9));
            for (const LocalContact& contact : system.contacts) REQUIRE(contact.impulses.normal >= 0);
        }
    }
    // A descent that is cut short leaves velocities and impulses that do not belong to each other, and what
    // surfaces drive is worked out from impulses: their work missed 110 times all energy in these trials.
    TEST_CASE("what surfaces drive is of the size of what bodies gain") {
        constexpr int kBodies = 12, kSize = 3;
        Random random(13);
        const auto draw = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random.next() % 100'001) * 1e-5;
        };
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> mass;
            for (int i = 0; i < kBodies; ++i) mass.push_back(std::pow(10, draw(0, 6)));
            System<kSize> system(mass);
            for (auto& velocity : system.velocity)
                for (double& part : velocity) part = draw(-1, 1);
            for (std::int32_t i = 0; i < 24; ++i) {
                // The last twelve are with surfaces, so that each body has one that moves.
                const std::int32_t a = i % kBodies,
                                   b = i < kBodies ? static_cast<std::int32_t>(random.next() % kBodies) : -1;
                if (a == b) continue;
                const double angle = draw(0, 6.3);
                system.contacts.push_back(contact_of(a, b, std::cos(angle), std::sin(angle), draw(0, 1)));
                system.contacts.back().impulses.normal = std::pow(10, draw(-3, 7));
                if (b < 0) system.contacts.back().surface_normal = draw(-3, 3);
            }
            const auto before = system.velocity;
            double energy = 0, gained = 0;  // J: the most that each part of a velocity has, and the slack
            system.step(0);
            for (std::size_t i = 0; i < kBodies; ++i) {
                energy += 10 * mass[i] * kFall * kFall;
                for (std::size_t k = 0; k < kSize; ++k) {
                    const double of = (k < 2 ? 0.5 : 0.25) * mass[i], from = before[i][k],
                                 to = system.velocity[i][k];
                    energy += of * std::fmax(from * from, to * to), gained += of * (to * to - from * from);
                }
            }
            double work = 0;  // J, of all impulses at mean velocities
            for (const LocalContact& contact : system.contacts)
                for (const bool is_b : {false, true}) {
                    const std::int32_t body = is_b ? contact.b : contact.a;
                    if (body < 0) continue;
                    const double sign = is_b ? 1 : -1, nx = sign * contact.terms.nx,
                                 ny = sign * contact.terms.ny;
                    const auto mean = [&](std::size_t k) {
                        const auto row = static_cast<std::size_t>(body);
                        return 0.5 * (before[row][k] + system.velocity[row][k]);
                    };
                    work += contact.impulses.normal * (nx * mean(0) + ny * mean(1));
                    work += contact.impulses.tangent * (nx * mean(1) - ny * mean(0) - mean(2)) +
                            contact.impulses.rolling * (is_b ? 0.5 : -0.5) * mean(2);
                }
            // Impulses that fit best give no more than velocities have changed by, twice the largest each.
            REQUIRE(std::fabs(gained - work) <= 8 * energy);
        }
    }
}

}  // namespace test_contact_relaxation

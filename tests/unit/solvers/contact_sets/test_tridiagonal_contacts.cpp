// Contacts in a row: against a solver that tries every set of contacts that may push, and by their laws.
#include "solvers/contact_sets/tridiagonal_contacts.hpp"

#include "support/complementarity.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace test_tridiagonal_contacts {

using namespace carom;
using namespace carom::test;

namespace {

/// Discs of masses 1e-3 to 1e3, one behind the other, some on a floor, with random velocities; contacts turn
/// by up to `turn` [rad].
TridiagonalContacts random_line(std::size_t count, double turn, std::mt19937& random) {
    const auto number = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    TridiagonalContacts line;
    double inverse_before = random() % 2 == 0 ? 0 : std::pow(10, number(-3, 3));
    for (std::size_t n = 0; n < count; ++n) {
        const double inverse = std::pow(10, number(-3, 3));
        line.contacts.push_back({number(-1, 1), random() % 3 == 0 ? number(-1, 0) : 0,
                                 inverse_before + inverse, -inverse * std::cos(number(0, turn)), 0});
        inverse_before = inverse;
    }
    return line;
}

double velocity_of(const TridiagonalContacts& line, std::size_t n) {
    const auto& c = line.contacts;
    double velocity = c[n].velocity + c[n].diagonal * c[n].impulse;
    if (n > 0) velocity += c[n - 1].coupling * c[n - 1].impulse;
    if (n + 1 < c.size()) velocity += c[n].coupling * c[n + 1].impulse;
    return velocity;
}

}  // namespace

TEST_SUITE("solvers/contact_sets/tridiagonal_contacts") {
    TEST_CASE("contacts in a row are solved as one that tries all sets of them does") {
        std::mt19937 random(11);
        for (int trial = 0; trial < 300; ++trial) {
            const auto count = static_cast<std::size_t>(1 + trial % 9);
            TridiagonalContacts line = random_line(count, 1.5, random);
            Complementarity all(count);
            for (std::size_t n = 0; n < count; ++n) {
                const TridiagonalContact& c = line.contacts[n];
                all.a(n, n) = c.diagonal, all.b(n) = c.velocity - c.floor;
                if (n + 1 < count) all.a(n, n + 1) = all.a(n + 1, n) = c.coupling;
            }
            const auto expected = all.solve();
            REQUIRE(expected.size() == count);
            line.solve();
            double largest = 0;
            for (const long double impulse : expected)
                largest = std::fmax(largest, static_cast<double>(impulse));
            for (std::size_t n = 0; n < count; ++n)
                CHECK(std::fabs(line.contacts[n].impulse - static_cast<double>(expected[n])) <
                      1e-9 * largest + 1e-15);
        }
    }

    TEST_CASE("every contact of a long row keeps its law") {
        std::mt19937 random(12);
        for (const double turn : {0.0, 0.3}) {
            TridiagonalContacts line = random_line(5000, turn, random);
            line.solve();
            std::size_t pushing = 0;
            for (std::size_t n = 0; n < line.contacts.size(); ++n) {
                const TridiagonalContact& c = line.contacts[n];
                const double above = velocity_of(line, n) - c.floor;
                CHECK(c.impulse >= 0);
                CHECK(above > -1e-9);
                CHECK((c.impulse == 0 || above < 1e-9));
                pushing += c.impulse > 0;
            }
            CHECK(pushing > 1000);
            CHECK(pushing < 4999);
        }
    }

    TEST_CASE("a column at rest carries its weight: each contact that of all above it") {
        TridiagonalContacts line;
        constexpr std::size_t kCount = 1000;
        constexpr double kMass = 2, kFall = 0.04;  // kg, m/s
        for (std::size_t n = 0; n < kCount;
             ++n)  // the first stands on the floor; all have fallen for a while
            line.contacts.push_back({n == 0 ? -kFall : 0, 0, (n == 0 ? 1 : 2) / kMass, -1 / kMass, 0});
        line.solve();
        for (std::size_t n = 0; n < kCount; ++n)
            CHECK(line.contacts[n].impulse ==
                  doctest::Approx(kMass * kFall * static_cast<double>(kCount - n)).epsilon(1e-9));
    }
}

}  // namespace test_tridiagonal_contacts

// Supports of one body: against a solver that tries every set of contacts that may push, and by their laws.
#include "solvers/contact_sets/support_normals.hpp"

#include "support/complementarity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

#include "math/vec2_math.hpp"

namespace test_support_normals {

using namespace carom;
using namespace carom::test;

namespace {

double between(std::mt19937& random, double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
}

std::vector<SupportNormal> random_supports(std::size_t count, std::mt19937& random) {
    std::vector<SupportNormal> supports;
    for (std::size_t i = 0; i < count; ++i) {
        const double angle = between(random, 0, 6.28);
        supports.push_back({{std::cos(angle), std::sin(angle)},
                            between(random, -1, 1),
                            random() % 2 == 0 ? between(random, 0, 3) : 0});
    }
    return supports;
}

}  // namespace

TEST_SUITE("solvers/contact_sets/support_normals") {
    TEST_CASE("supports of a body are solved as one that tries all sets of them does") {
        std::mt19937 random(17);
        int solved = 0;
        for (int trial = 0; trial < 2000; ++trial) {
            std::vector<SupportNormal> supports =
                random_supports(1 + static_cast<std::size_t>(trial % 4), random);
            const double inverse_mass = std::pow(10, between(random, -3, 3));
            Vec2 velocity{between(random, -2, 2), between(random, -2, 2)};
            Vec2 free = velocity;
            for (const SupportNormal& s : supports) free += inverse_mass * s.impulse * s.normal;
            Complementarity all(supports.size());
            for (std::size_t i = 0; i < supports.size(); ++i) {
                all.b(i) = supports[i].most - dot(free, supports[i].normal);
                for (std::size_t k = 0; k < supports.size(); ++k)
                    all.a(i, k) = inverse_mass * dot(supports[i].normal, supports[k].normal);
            }
            const auto expected = all.solve();
            const bool is_solved = solve_support_normals(velocity, inverse_mass, supports, 1e-9);
            if (expected.empty()) continue;
            // Squeezed out at more than 64 times the speed of what squeezes, which is left alone.
            if (!is_solved) {
                bool are_parallel = false;
                for (const SupportNormal& one : supports)
                    for (const SupportNormal& other : supports)
                        are_parallel |= &one != &other && dot(one.normal, other.normal) < -0.9998;
                CHECK(are_parallel);
                continue;
            }
            ++solved;
            Vec2 wanted = free;
            for (std::size_t i = 0; i < supports.size(); ++i)
                wanted -= inverse_mass * static_cast<double>(expected[i]) * supports[i].normal;
            const double size = 1 + std::sqrt(length_squared(wanted));
            CHECK(std::fabs(velocity.x - wanted.x) < 1e-7 * size);
            CHECK(std::fabs(velocity.y - wanted.y) < 1e-7 * size);
            Vec2 pushed = free;
            for (const SupportNormal& s : supports) {
                CHECK(s.impulse >= 0);
                pushed -= inverse_mass * s.impulse * s.normal;
            }
            CHECK(std::fabs(pushed.x - velocity.x) < 1e-9 * size);
            CHECK(std::fabs(pushed.y - velocity.y) < 1e-9 * size);
        }
        CHECK(solved > 1000);
    }
    TEST_CASE("a wedge that closes drives a body out at its speed over tan(angle)") {
        for (const double angle : {0.02, 0.2, 1.0}) {
            std::vector<SupportNormal> supports{{{0, -1}, 0},
                                                {{-std::sin(angle), std::cos(angle)}, -std::cos(angle)}};
            Vec2 velocity;
            REQUIRE(solve_support_normals(velocity, 2, supports, 1e-9));
            CHECK(velocity.x * std::tan(angle) == doctest::Approx(1).epsilon(1e-9));
            CHECK(std::fabs(velocity.y) < 1e-9);
        }
    }
    TEST_CASE("what parallel surfaces squeeze is left as it is") {
        std::vector<SupportNormal> supports{{{0, -1}, 0, 0.5}, {{0, 1}, -1, 0.25}};
        Vec2 velocity{3, -0.5};
        CHECK_FALSE(solve_support_normals(velocity, 2, supports, 1e-9));
        CHECK(velocity == Vec2{3, -0.5});
        CHECK(supports[0].impulse == 0.5);
        CHECK(supports[1].impulse == 0.25);
    }
}

}  // namespace test_support_normals

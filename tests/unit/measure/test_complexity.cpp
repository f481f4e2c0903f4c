#include "measure/complexity.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <vector>

namespace test_complexity {

using namespace carom::measure;

namespace {

std::vector<Cost> costs_of(double (*seconds)(double), double wobble = 0) {
    std::vector<Cost> costs;
    double sign = 1;
    for (double size = 1000; size < 2e6; size *= 10) {
        costs.push_back({size, seconds(size) * (1 + sign * wobble)});
        sign = -sign;
    }
    return costs;
}

/// Rounds of two methods with times c1 N and c2 N^0: they cross where c1 N = c2.
struct Rounds {
    std::vector<std::vector<double>> first, second;
    std::vector<Duel> duels;

    Rounds(double crossing, double spread) {
        for (double size = 10; size <= 1000; size *= 10) {
            first.emplace_back(), second.emplace_back();
            for (int round = 0; round < 9; ++round) {
                first.back().push_back(size * (1 + spread * (round - 4) / 4));
                second.back().push_back(crossing);
            }
        }
        for (std::size_t i = 0; i < first.size(); ++i)
            duels.push_back({std::pow(10.0, static_cast<double>(i + 1)), first[i], second[i]});
    }
};

}  // namespace

TEST_SUITE("measure/complexity") {
    TEST_CASE("a power law without noise is found exactly, with no error to its exponent") {
        const PowerLaw law = fit_power_law(costs_of([](double n) { return 3e-9 * std::pow(n, 1.25); }));
        CHECK(law.exponent == doctest::Approx(1.25).epsilon(1e-12));
        CHECK(law.coefficient == doctest::Approx(3e-9).epsilon(1e-10));
        CHECK(law.exponent_error < 1e-12);
    }

    TEST_CASE("noise of 10 % leaves the true exponent within two standard errors") {
        const PowerLaw law = fit_power_law(costs_of([](double n) { return 1e-9 * n * n; }, 0.1));
        CHECK(law.exponent_error > 0.005);
        CHECK(std::abs(law.exponent - 2) < 2 * law.exponent_error);
    }

    TEST_CASE("each complexity is recognised, also with noise of 5 %") {
        CHECK(nearest_complexity(costs_of([](double n) { return n; }, 0.05)).name == "O(N)");
        CHECK(nearest_complexity(costs_of([](double n) { return n * std::log2(n); }, 0.05)).name ==
              "O(N log N)");
        CHECK(nearest_complexity(costs_of([](double n) { return n * std::sqrt(n); }, 0.05)).name ==
              "O(N^1.5)");
        CHECK(nearest_complexity(costs_of([](double n) { return n * n; }, 0.05)).name == "O(N^2)");
    }

    TEST_CASE("the deviation from a complexity is the size of the noise") {
        const Complexity nearest = nearest_complexity(costs_of([](double n) { return n; }, 0.05));
        CHECK(nearest.deviation == doctest::Approx(0.05).epsilon(0.01));
    }

    TEST_CASE("a crossover is where the two times are equal, and its spread is that of the rounds") {
        const Rounds exact(70, 0), noisy(70, 0.2);
        const Crossover found = find_crossover(exact.duels);
        REQUIRE(found.kind == Crossover::Kind::crosses);
        CHECK(found.size.median == doctest::Approx(70).epsilon(1e-9));
        CHECK(found.size.high == doctest::Approx(found.size.low));

        const Crossover spread = find_crossover(noisy.duels);
        REQUIRE(spread.kind == Crossover::Kind::crosses);
        CHECK(spread.size.low < 70);
        CHECK(spread.size.high > 70);
        CHECK(spread.size.high < 1.3 * 70);
    }

    TEST_CASE("a method that is faster or slower at every size has no crossover") {
        CHECK(find_crossover(Rounds(5, 0).duels).kind == Crossover::Kind::always);
        CHECK(find_crossover(Rounds(5000, 0).duels).kind == Crossover::Kind::never);
    }

    TEST_CASE("where times cross twice, the last crossing counts") {
        const std::vector<double> slow{2, 2, 2}, fast{1, 1, 1};
        const std::vector<Duel> duels{{10, slow, fast}, {100, fast, slow}, {1000, slow, fast}};
        const Crossover found = find_crossover(duels);
        REQUIRE(found.kind == Crossover::Kind::crosses);
        CHECK(found.size.median > 100);
        CHECK(found.size.median < 1000);
    }
}

}  // namespace test_complexity

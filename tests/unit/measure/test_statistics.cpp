#include "measure/statistics.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <vector>

namespace test_statistics {

using namespace carom::measure;

TEST_SUITE("measure/statistics") {
    TEST_CASE("quantiles lie between the values around them") {
        const std::vector<double> values{4, 1, 3, 2};
        CHECK(quantile(values, 0) == 1);
        CHECK(quantile(values, 1) == 4);
        CHECK(quantile(values, 0.5) == 2.5);
        CHECK(quantile(values, 0.25) == 1.75);
        CHECK(quantile(std::vector<double>{7}, 0.3) == 7);
    }

    TEST_CASE("one slow round does not move the median's interval") {
        const std::vector<double> values{1, 1.01, 0.99, 1, 1.02, 0.98, 1, 1.01, 50};
        const Spread interval = median_interval(values);
        CHECK(interval.median == 1);
        CHECK(interval.low >= 0.98);
        CHECK(interval.high <= 1.02);
    }

    TEST_CASE("an interval of 95 % holds the true median about 95 times of a hundred") {
        std::mt19937 random(5);
        std::lognormal_distribution<double> times(0, 0.3);  // skewed, as times are; its median is 1
        int held = 0;
        const int kExperiments = carom::test::scaled(400, 100);
        for (int i = 0; i < kExperiments; ++i) {
            std::vector<double> values(15);
            for (double& value : values) value = times(random);
            const Spread interval = median_interval(values);
            held += interval.low <= 1 && 1 <= interval.high ? 1 : 0;
        }
        CHECK(held > 0.90 * kExperiments);
        CHECK(held < 0.99 * kExperiments);
    }

    TEST_CASE("a drift that hits both contestants alike does not show in their ratio") {
        std::vector<double> a, b;
        for (int round = 0; round < 10; ++round) {
            a.push_back(2.0 * (1 + 0.3 * round));
            b.push_back(1.0 * (1 + 0.3 * round));
        }
        const Spread interval = median_interval(ratios(a, b));
        CHECK(interval.low == doctest::Approx(2));
        CHECK(interval.high == doctest::Approx(2));
    }

    TEST_CASE("the same values give the same interval") {
        const std::vector<double> values{3, 1, 4, 1, 5, 9, 2, 6};
        const Spread once = median_interval(values), again = median_interval(values);
        CHECK(once.low == again.low);
        CHECK(once.high == again.high);
    }
}

}  // namespace test_statistics

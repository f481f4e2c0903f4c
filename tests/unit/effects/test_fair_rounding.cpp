// What gravity adds step by step must add up, though every step rounds it.
#include "effects/fair_rounding.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace test_fair_rounding {

using namespace carom;

namespace {

/// Adds `gain` to `start` so many times and returns how far off the sum ends, in units in its last place.
template <class Real>
double drift(Real start, double gain, int steps, bool is_dithered) {
    Real value = start;
    const Real binade = std::ldexp(Real{1}, std::ilogb(start));
    for (int n = 1; n <= steps; ++n) {
        const Real extra =
            is_dithered ? binade * dither_factor<Real>(static_cast<std::uint64_t>(n)) : Real{0};
        value = value + (static_cast<Real>(gain) + extra);
    }
    const double unit = static_cast<double>(binade * std::numeric_limits<Real>::epsilon());
    const double exact = static_cast<double>(static_cast<Real>(gain)) * steps;
    return std::fabs(static_cast<double>(value - start) - exact) / unit;
}

}  // namespace

TEST_SUITE("effects/fair rounding") {
    TEST_CASE("the numbers stay within half a unit and fill it evenly from any step on") {
        for (const std::uint64_t first : {std::uint64_t{1}, std::uint64_t{1} << 33}) {
            constexpr int kBins = 20, kNumbers = 1000;
            int count[kBins] = {};
            for (std::uint64_t n = first; n < first + kNumbers; ++n) {
                const double d = dither(n);
                REQUIRE(d >= -0.5);
                REQUIRE(d < 0.5);
                ++count[static_cast<int>((d + 0.5) * kBins)];
            }
            const auto [least, most] = std::minmax_element(count, count + kBins);
            CHECK(*least >= kNumbers / kBins - 3);
            CHECK(*most <= kNumbers / kBins + 3);
        }
    }

    TEST_CASE_TEMPLATE("a sum of many small numbers stays within a few units, where plain rounding drifts",
                       Real, float, double) {
        const double unit = static_cast<double>(8 * std::numeric_limits<Real>::epsilon());
        for (const double part : {0.1, 0.3, 0.5, 0.77, 4.4}) {  // of a unit
            CAPTURE(part);
            const double gain = part * unit;
            CHECK(drift<Real>(Real{8}, gain, 100'000, true) < 4);
            CHECK(drift<Real>(Real{-9}, gain, 100'000, true) < 4);
            CHECK(drift<Real>(Real{8}, gain, 100'000, false) > 5'000);
        }
    }
}

}  // namespace test_fair_rounding

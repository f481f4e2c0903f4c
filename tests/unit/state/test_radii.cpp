// The usual radius, against a sorted list.
#include "state/radii.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace test_radii {

using namespace carom;

namespace {

template <class Real>
Bodies<Real> bodies_of(const std::vector<double>& radii) {
    Bodies<Real> bodies;
    bodies.resize(radii.size());
    for (std::size_t row = 0; row < radii.size(); ++row)
        bodies.radius.set(row, radii.size(), static_cast<Real>(radii[row]));
    return bodies;
}

}  // namespace

TEST_SUITE("state/radii") {
    TEST_CASE_TEMPLATE(
        "at most one disc in sixteen is smaller than the usual ones, and hardly fewer could be", Real, float,
        double) {
        std::mt19937 random(3);
        for (const std::size_t count : {1u, 2u, 15u, 16u, 17u, 32u, 33u, 1000u})
            for (int sort = 0; sort < 20; ++sort) {
                CAPTURE(count);
                std::vector<double> radii(count);
                for (double& radius : radii)
                    radius = std::exp(-0.5 * sort * static_cast<double>(random()) / 4294967296.0);
                const Radii found = measure_radii(bodies_of<Real>(radii));
                std::sort(radii.begin(), radii.end());
                CHECK(found.smallest == static_cast<double>(static_cast<Real>(radii.front())));
                CHECK(found.largest == static_cast<double>(static_cast<Real>(radii.back())));
                const auto is_less = [&](double radius) { return radius < found.usual * (1 - 1e-6); };
                const auto smaller =
                    static_cast<std::size_t>(std::count_if(radii.begin(), radii.end(), is_less));
                CHECK(16 * smaller <= count);
                // Of bins, so that it is less than the exact one by an octave at most.
                const double exact = radii[count / 16];
                CHECK(found.usual <= exact * (1 + 1e-6));
                CHECK(found.usual > exact / 2.001);
            }
    }

    TEST_CASE(
        "one small disc among sixteen does not count, two do, and those that nothing moves do not either") {
        std::vector<double> radii(32, 0.5);
        radii[7] = radii[20] = 1e-3;
        Bodies<double> bodies = bodies_of<double>(radii);
        CHECK(measure_radii(bodies).usual == 0.5);
        radii[21] = 1e-3;
        bodies = bodies_of<double>(radii);
        CHECK(measure_radii(bodies).usual == 1e-3);
        bodies.set_flags(21, kImmovable);
        CHECK(measure_radii(bodies).usual == 1e-3);  // two of 31
        bodies.set_flags(20, kImmovable);
        CHECK(measure_radii(bodies).usual == 0.5);
        CHECK(measure_radii(bodies).smallest == 1e-3);
    }

    TEST_CASE("without discs there is no radius") {
        Bodies<float> bodies;
        CHECK(measure_radii(bodies).usual == 0);
        bodies.resize(1);
        bodies.radius.set_any(0, 1, 1);
        bodies.set_flags(0, kImmovable | kEdges);
        CHECK(measure_radii(bodies).usual == 0);
        CHECK(measure_radii(bodies).largest == 0);
    }
}

}  // namespace test_radii

#include "math/rotation.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>

using namespace carom;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

}  // namespace

TEST_SUITE("math/rotation") {
    TEST_CASE("cosine and sine are within 2e-16 of the library's for angles up to 1e8") {
        std::mt19937_64 random(5);
        double worst = 0;
        for (const double largest : {1e-6, 1.0, 10.0, 1e3, 1e8})
            for (int i = 0; i < 20'000; ++i) {
                const double angle = std::uniform_real_distribution<double>(-largest, largest)(random);
                const Rotation turn = rotation_by(angle);
                worst = std::fmax(worst, std::fabs(turn.cos - std::cos(angle)));
                worst = std::fmax(worst, std::fabs(turn.sin - std::sin(angle)));
            }
        CHECK(worst <= 2.3e-16);
    }

    TEST_CASE("quarter turns are exact to rounding, and no turn is exact") {
        CHECK(rotation_by(0).cos == 1);
        CHECK(rotation_by(0).sin == 0);
        for (int quarters = -9; quarters <= 9; ++quarters) {
            CAPTURE(quarters);
            const Rotation turn = rotation_by(quarters * 1.5707963267948966);
            CHECK(std::fabs(turn.cos - (quarters % 2 != 0 ? 0 : quarters % 4 == 0 ? 1 : -1)) <= 1e-15);
        }
    }

    TEST_CASE("turning back undoes a turn") {
        const Rotation turn = rotation_by(0.7);
        const Vec2 back = rotate_back(turn, rotate(turn, {3, -2}));
        CHECK(back.x == doctest::Approx(3).epsilon(1e-15));
        CHECK(back.y == doctest::Approx(-2).epsilon(1e-15));
    }

    TEST_CASE("a turn keeps lengths whatever the angle, and is none where the angle says no direction") {
        for (const double angle : {1e9, -1e10, 1e12, -1e15, 1.3e19, -1e300, kInfinity, -kInfinity, kNaN}) {
            const Rotation turn = rotation_by(angle);
            CAPTURE(angle);
            CHECK(turn.cos * turn.cos + turn.sin * turn.sin == doctest::Approx(1).epsilon(0.1));
            if (!(std::fabs(angle) <= 1e15)) CHECK(turn.cos == 1);
        }
    }
}

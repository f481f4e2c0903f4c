#include "math/rotation.hpp"

#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>

#include "isa/select_isa.hpp"

namespace test_rotation {

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

    TEST_CASE("by lanes angles have the bits that they have one by one, on every instruction set") {
        std::mt19937_64 random(7);
        alignas(64) double angles[kAnglesOfBlock], cosines[kAnglesOfBlock], sines[kAnglesOfBlock];
        for (const double largest : {1e-9, 1.0, 7.0, 1e3, 1e8, 1e15}) {
            for (double& angle : angles)
                angle = std::uniform_real_distribution<double>(-largest, largest)(random);
            for (int quarters = -9; quarters <= 9; ++quarters)
                angles[quarters + 9] = quarters * 1.5707963267948966;
            angles[20] = kNaN, angles[21] = kInfinity, angles[22] = -2e15, angles[23] = -0.0;
            for (const KernelTables* tables : runnable_kernel_tables()) {
                tables->double_precision.convex->turn_angles(angles, cosines, sines);
                for (std::size_t i = 0; i < kAnglesOfBlock; ++i) {
                    CAPTURE(angles[i]);
                    const Rotation turn = rotation_by(angles[i]);
                    CHECK(std::bit_cast<std::uint64_t>(cosines[i]) == std::bit_cast<std::uint64_t>(turn.cos));
                    CHECK(std::bit_cast<std::uint64_t>(sines[i]) == std::bit_cast<std::uint64_t>(turn.sin));
                }
            }
        }
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

}  // namespace test_rotation

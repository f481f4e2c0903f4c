// Overlaps at the end of a step: what is pushed, how far, and what stays where it is.
#include "solvers/contact_sets/project_positions.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace test_project_positions {

using namespace carom;

namespace {

/// Discs with masses, and all their pairs that are near.
struct Crowd {
    PositionProjection projection;
    std::vector<Vec2> before;
    std::vector<double> mass;

    void add(Vec2 place, double of_mass = 1) {
        projection.place.push_back(place), mass.push_back(of_mass);
        projection.is_marked.push_back(0), projection.is_moved.push_back(0);
        before.push_back(place);
    }
    void add_pair(std::int32_t a, std::int32_t b, double reach, double least) {
        const double of_a = 1 / mass[static_cast<std::size_t>(a)],
                     of_b = 1 / mass[static_cast<std::size_t>(b)];
        projection.pairs.push_back({a, b, {}, reach, least, of_a / (of_a + of_b), of_b / (of_a + of_b)});
    }
    Vec2 place(std::size_t row) const { return projection.place[row]; }
    Vec2 centre_of_mass() const {
        Vec2 sum;
        double total = 0;
        for (std::size_t row = 0; row < mass.size(); ++row)
            sum += mass[row] * projection.place[row], total += mass[row];
        return (1 / total) * sum;
    }
    /// Of the deepest pair, beyond what it may overlap, as a share of that.
    double missing() const {
        double worst = 0;
        for (const PositionProjection::Pair& p : projection.pairs) {
            const Vec2 b = p.b < 0 ? p.place : place(static_cast<std::size_t>(p.b));
            const double distance = std::sqrt(length_squared(b - place(static_cast<std::size_t>(p.a))));
            worst = std::fmax(worst, (p.reach + p.least - distance) / -p.least);
        }
        return worst;
    }
    /// Rows are flagged if and only if they are not where they were.
    bool are_flags_right() const {
        for (std::size_t row = 0; row < before.size(); ++row)
            if ((projection.is_moved[row] != 0) != (place(row) != before[row])) return false;
        return true;
    }
};

}  // namespace

TEST_SUITE("solvers/contact_sets/project_positions") {
    TEST_CASE("two discs part along their line to what they may overlap, each by its inverse mass") {
        Crowd crowd;
        crowd.add({1, 1}, 1), crowd.add({1.3, 1.4}, 3);  // 0.5 m apart
        crowd.add_pair(0, 1, 1, -0.02);
        const Vec2 centre = crowd.centre_of_mass();
        CHECK(crowd.projection.part());
        const Vec2 d = crowd.place(1) - crowd.place(0);
        CHECK(d.x == doctest::Approx(0.98 * 0.6).epsilon(1e-14));
        CHECK(d.y == doctest::Approx(0.98 * 0.8).epsilon(1e-14));
        CHECK(std::sqrt(length_squared(crowd.centre_of_mass() - centre)) < 1e-15);
        CHECK(crowd.are_flags_right());
        CHECK_FALSE(crowd.projection.part());  // nothing is left to do
    }

    TEST_CASE("what nothing moves stays, and what is far enough as well") {
        Crowd crowd;
        crowd.add({0, 0}), crowd.add({0.985, 0}), crowd.add({5, 5});
        crowd.add_pair(0, 1, 1, -0.02);
        crowd.projection.pairs.push_back({2, -1, {5, 5.6}, 1, -0.02, 1, 0});
        CHECK(crowd.projection.part());
        CHECK(crowd.place(0) == Vec2{0, 0});
        CHECK(crowd.place(1) == Vec2{0.985, 0});
        CHECK(crowd.place(2).x == 5);
        CHECK(crowd.place(2).y == doctest::Approx(5.6 - 0.98).epsilon(1e-14));
        CHECK(crowd.are_flags_right());
    }

    TEST_CASE("coincident centres part, in any rows") {
        for (std::int32_t shift = 0; shift < 20; ++shift) {
            Crowd crowd;
            for (std::int32_t row = 0; row < 3 + shift; ++row) crowd.add({7, -3});
            const std::int32_t a = shift / 2, b = shift + 2;
            crowd.add_pair(a, b, 1, -0.02);
            CHECK(crowd.projection.part());
            const Vec2 d =
                crowd.place(static_cast<std::size_t>(b)) - crowd.place(static_cast<std::size_t>(a));
            CHECK(std::sqrt(length_squared(d)) == doctest::Approx(0.98).epsilon(1e-13));
            CHECK(crowd.are_flags_right());
        }
    }

    TEST_CASE("a plane pushes a disc out along its normal alone") {
        Crowd crowd;
        crowd.add({2, 0.2}), crowd.add({3, 0.5});
        const Vec2 into{0, -1};
        for (const std::int32_t row : {0, 1}) crowd.projection.planes.push_back({row, into, 0, 0.5});
        CHECK(crowd.projection.push_from_planes());
        CHECK(crowd.place(0).x == 2);
        CHECK(crowd.place(0).y == doctest::Approx(0.5).epsilon(1e-15));
        CHECK(crowd.place(1) == Vec2{3, 0.5});
        CHECK(crowd.are_flags_right());
    }

    TEST_CASE("a crowd with room around it is parted, and its centre of mass stays") {
        for (unsigned seed = 1; seed <= 10; ++seed) {
            CAPTURE(seed);
            std::mt19937 random(seed);
            const auto draw = [&](double low, double high) {
                return low + (high - low) * static_cast<double>(random() % 100001) * 1e-5;
            };
            Crowd crowd;
            std::vector<double> radius;
            for (int i = 0; i < 60; ++i) {
                // One after the other: compilers differ in the order of arguments.
                const double x = draw(0, 14), y = draw(0, 14), mass = draw(0.5, 5);
                crowd.add({x, y}, mass);
                radius.push_back(draw(0.3, 0.6));
            }
            for (std::int32_t b = 0; b < 60; ++b)
                for (std::int32_t a = 0; a < b; ++a) {
                    const double of_a = radius[static_cast<std::size_t>(a)],
                                 of_b = radius[static_cast<std::size_t>(b)];
                    crowd.add_pair(a, b, of_a + of_b, -0.02 * std::fmin(of_a, of_b));
                }
            const Vec2 centre = crowd.centre_of_mass();
            CHECK(crowd.missing() > 10);
            CHECK(crowd.projection.part());
            CHECK(crowd.missing() <= 0.1);
            CHECK(std::sqrt(length_squared(crowd.centre_of_mass() - centre)) < 1e-13);
            CHECK(crowd.are_flags_right());
        }
    }

    TEST_CASE("discs squeezed between a plane and an immovable disc end in neither, if there is room") {
        Crowd crowd;
        for (int i = 0; i < 5; ++i) crowd.add({0.1 * i, 0.2 + 0.05 * i});
        for (std::int32_t b = 0; b < 5; ++b) {
            for (std::int32_t a = 0; a < b; ++a) crowd.add_pair(a, b, 1, -0.01);
            crowd.projection.planes.push_back({b, {0, -1}, 0, 0.5});
            crowd.projection.pairs.push_back({b, -1, {0.2, 3.2}, 1, -0.01, 1, 0});
        }
        CHECK(crowd.projection.part());
        CHECK(crowd.missing() <= 0.1);
        for (std::size_t row = 0; row < 5; ++row) CHECK(crowd.place(row).y > 0.5 - 0.1 * 0.5);
        CHECK(crowd.are_flags_right());
    }
}

}  // namespace test_project_positions

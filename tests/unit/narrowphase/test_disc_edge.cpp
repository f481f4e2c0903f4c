#include "narrowphase/disc_edge.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <random>

namespace test_disc_edge {

using namespace carom;

namespace {

/// The first of many places on the way at which the disc touches, or the nearest one.
double time_by_looking(Vec2 p0, Vec2 way, Vec2 a, Vec2 b, double radius, int places) {
    double nearest = INFINITY, time = 0;
    for (int i = 0; i <= places; ++i) {
        const double t = static_cast<double>(i) / places;
        const double there = std::sqrt(distance_squared(p0 + t * way, a, b));
        if (there <= radius) return t;
        if (there < nearest) nearest = there, time = t;
    }
    return time;
}

Chain corner_at_origin(Vec2 before, Vec2 after) {
    return {.points = {before, {0, 0}, after}};
}

/// Which of the two edges of a chain through the origin a disc at p touches: bit 0 the first, bit 1 the
/// second.
int touched(const EdgeStore& edges, Vec2 p) {
    int bits = 0;
    for (std::int32_t e = 0; e < 2; ++e)
        if (is_touched_here(p, nearest_share(p, edges[e].a, edges[e].b), edges, edges[e])) bits |= 1 << e;
    return bits;
}

}  // namespace

TEST_SUITE("narrowphase/disc_edge") {
    TEST_CASE("the time of meeting is the first at which a disc touches, or that of the nearest place") {
        std::mt19937 random(11);
        std::uniform_real_distribution<double> place(-3, 3);
        constexpr int kPlaces = 5'000;
        int met = 0;
        for (int i = 0; i < test::scaled(1500, 1000); ++i) {
            const Vec2 p0{place(random), place(random)}, way{place(random), place(random)};
            const Vec2 a{place(random), place(random)}, b{place(random), place(random)};
            CAPTURE(i);
            const double time = time_of_meeting(p0, way, a, b, 0.4);
            const double looked = time_by_looking(p0, way, a, b, 0.4, kPlaces);
            const double here = std::sqrt(distance_squared(p0 + time * way, a, b));
            const double there = std::sqrt(distance_squared(p0 + looked * way, a, b));
            CHECK(std::fabs(here - there) <= 2e-3);
            if (there > 0.4 || time == 0) continue;
            CHECK(std::fabs(time - looked) <= 2.0 / kPlaces + 1e-9);
            CHECK(here == doctest::Approx(0.4).epsilon(1e-9));
            ++met;
        }
        CHECK(met > 100);
    }

    TEST_CASE("a disc is met on both sides, at both ends, and where it stands if it overlaps") {
        const Vec2 a{-1, 0}, b{1, 0};
        CHECK(time_of_meeting({0, 3}, {0, -5}, a, b, 0.5) == doctest::Approx(0.5));
        CHECK(time_of_meeting({0, -3}, {0, 5}, a, b, 0.5) == doctest::Approx(0.5));
        CHECK(time_of_meeting({4, 0}, {-5, 0}, a, b, 0.5) == doctest::Approx(0.5));
        CHECK(time_of_meeting({-4, 0}, {5, 0}, a, b, 0.5) == doctest::Approx(0.5));
        CHECK(time_of_meeting({0, 0.4}, {0, -5}, a, b, 0.5) == 0);
        CHECK(time_of_meeting({0, 3}, {0, 5}, a, b, 0.5) == 0);
        CHECK(time_of_meeting({-2, 3}, {4, 0}, a, b, 0.5) == doctest::Approx(0.25));  // passes at height 3
        CHECK(time_of_meeting({0, 3}, {0, 0}, a, b, 0.5) == 0);
    }

    TEST_CASE("at a joint of a chain exactly one edge is touched from outside of the corner") {
        std::mt19937 random(2);
        std::uniform_real_distribution<double> angle(-3.1, 3.1);
        for (int i = 0; i < 300; ++i) {
            const double before = angle(random), after = angle(random), at = angle(random);
            const Vec2 from{std::cos(before), std::sin(before)}, to{std::cos(after), std::sin(after)};
            EdgeStore edges;
            edges.append({0, 0}, corner_at_origin(from, to));
            const Vec2 p{0.1 * std::cos(at), 0.1 * std::sin(at)};
            const bool beside_first = dot(p, from) > 0, beside_second = dot(p, to) > 0;
            CAPTURE(i);
            // Beside both, in the corner, both are walls; beside one it alone; else the corner, once.
            CHECK(touched(edges, p) == (beside_first && beside_second ? 3 : beside_second ? 2 : 1));
        }
    }

    TEST_CASE("the ends of a chain that is no loop are touched, those of a loop are joints") {
        EdgeStore edges;
        edges.append({0, 0}, Chain{.points = {{0, 0}, {1, 0}, {1, 1}}});
        CHECK(is_touched_here({-0.1, 0}, 0, edges, edges[0]));
        CHECK(is_touched_here({1, 1.1}, 1, edges, edges[1]));
        CHECK_FALSE(is_touched_here({1.1, 0}, 0, edges, edges[1]));
        EdgeStore loop;
        loop.append({0, 0}, Chain{.points = {{0, 0}, {1, 0}, {1, 1}}, .loop = true});
        REQUIRE(loop.edges.size() == 3);
        CHECK(loop[0].previous == 2);
        CHECK(loop[2].next == 0);
        CHECK_FALSE(is_touched_here({-0.1, -0.1}, 0, loop, loop[0]));
        CHECK(is_touched_here({-0.1, -0.1}, 1, loop, loop[2]));
    }

    TEST_CASE("what is beyond the box around an edge is farther from it than that, and most that is") {
        std::mt19937 random(3);
        std::uniform_real_distribution<double> coordinate(-2, 2), length(0.01, 1);
        int far = 0, told = 0;
        for (int i = 0; i < 4000; ++i) {
            Edge edge{};
            edge.a = {coordinate(random), coordinate(random)};
            edge.b = {coordinate(random), coordinate(random)};
            const Vec2 p{2 * coordinate(random), 2 * coordinate(random)};
            const double reach = length(random);
            const bool is_far = distance_squared(p, edge.a, edge.b) > reach * reach,
                       is_beyond = is_beyond_box(p, edge, reach);
            if (is_beyond) REQUIRE(is_far);
            far += is_far, told += is_beyond;
        }
        CHECK(far > 2000);
        CHECK(2 * told > far);
    }

    TEST_CASE("taking a body's edges out keeps the others' numbers and neighbours right") {
        EdgeStore edges;
        edges.append({0, 0}, Segment{{0, 0}, {1, 0}});
        edges.append({1, 0}, Chain{.points = {{0, 0}, {1, 0}, {1, 1}}});
        edges.append({2, 0}, Chain{.points = {{0, 0}, {3, 0}, {3, 4}}, .loop = true});
        const EdgeStore::Removed gone = edges.remove({1, 0});
        CHECK(gone.first == 1);
        CHECK(gone.count == 2);
        REQUIRE(edges.edges.size() == 4);
        CHECK(edges.body_of(1).id == BodyId{2, 0});
        CHECK(edges.body_of(1).first == 1);
        CHECK(edges[1].previous == 3);
        CHECK(edges[3].next == 1);
        CHECK(edges.body_of(1).reach == 5);
        CHECK(edges.remove({7, 0}).count == 0);
    }
}

}  // namespace test_disc_edge

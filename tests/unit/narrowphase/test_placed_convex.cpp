// Single pairs of convex shapes against supports of their vertices, and moving ones against fine steps.
#include "narrowphase/convex_impact_time.hpp"
#include "narrowphase/placed_convex.hpp"

#include "support/convex_pairs.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

namespace test_placed_convex {

using namespace carom;
using namespace carom::test;

namespace {

using enum ShapeKind;

constexpr ShapeKind kKinds[] = {disc, capsule, box, rounded_box, polygon, octagon, thin};

PlacedShape outline_of(const PlacedConvex& body) {
    const double pose[] = {body.centre.x, body.centre.y, body.turn.cos, body.turn.sin};
    return place(body.shape, pose);
}

MovingConvex draw_moving(ShapeKind kind, Draw& draw, double speed, double spin) {
    return {draw_shape<double>(kind, draw, draw(0.3, 1)),
            {draw(-3, 3), draw(-3, 3)},
            {draw(-speed, speed), draw(-speed, speed)},
            draw(-3, 3),
            draw(-spin, spin)};
}

}  // namespace

TEST_SUITE("narrowphase/convex") {
    TEST_CASE("separations and overlaps of single pairs are those of their supports") {
        for (const ShapeKind of_a : kKinds)
            for (const ShapeKind of_b : kKinds) {
                Draw draw(5);
                std::size_t bad = 0, overlapping = 0;
                for (int i = 0; i < 400; ++i) {
                    const PlacedConvex a = at_time(draw_moving(of_a, draw, 0, 0), 0);
                    PlacedConvex b = at_time(draw_moving(of_b, draw, 0, 0), 0);
                    b.centre = a.centre + Vec2{draw(-1.5, 1.5), draw(-1.5, 1.5)};
                    const PlacedShape of_this = outline_of(a), of_that = outline_of(b);
                    const double exact = signed_distance(of_this, of_that);
                    const Separation found = separation_of(a, b);
                    const double size = std::fmin(a.shape.inradius, b.shape.inradius);
                    // Vertices that all but coincide have no direction.
                    bad += std::fabs(found.distance - exact) > 3e-4 * size;
                    bad += std::fabs(gap_along(of_this, of_that, found.normal) - exact) > 3e-4 * size;
                    bad += std::fabs(overlap_of(a, b) - std::fmax(0, -exact) / size) > 3e-4;
                    overlapping += exact < 0;
                }
                CAPTURE(static_cast<int>(of_a));
                CAPTURE(static_cast<int>(of_b));
                CHECK(bad == 0);
                CHECK(overlapping > 50);
            }
    }

    TEST_CASE("a pair in double precision has the bits of the kernel where a is not turned") {
        ConvexPairs<double> pairs(512);
        draw_pairs(pairs, polygon, rounded_box, 3, 21);
        for (std::size_t i = 0; i < pairs.count(); ++i)
            pairs.pose()[8 * i + 2] = 1, pairs.pose()[8 * i + 3] = 0;
        runnable_kernel_tables().front()->double_precision.convex->find_manifolds(pairs.arguments(), 0, 512);
        std::size_t live = 0, other = 0;
        for (std::size_t i = 0; i < pairs.count(); ++i) {
            const FoundManifold m = pairs.found(i);
            if (!m.is_live()) continue;
            ++live;
            const double* pose = pairs.pose() + 8 * i;
            const Manifold<double> found =
                manifold_of(placed(pairs.shape(2 * i), {pose[0], pose[1]}, {pose[2], pose[3]}),
                            placed(pairs.shape(2 * i + 1), {pose[4], pose[5]}, {pose[6], pose[7]}));
            other += found.separation1 != m.separation[0] || found.normal_x != m.normal.x ||
                     found.normal_y != m.normal.y || found.lever_a1 != m.lever_a[0] ||
                     found.lever_b2 != m.lever_b[1] || found.lever_b_t != m.lever_b_t;
        }
        CHECK(live > 150);
        CHECK(other == 0);
    }

    TEST_CASE("shapes that move and turn are stopped before they meet, and not earlier than need be") {
        constexpr double kDt = 1.0 / 60, kTarget = 1e-3;
        const int kSteps = scaled(3000, 600);
        for (const ShapeKind of_a : kKinds)
            for (const ShapeKind of_b : {thin, polygon, capsule}) {
                Draw draw(9);
                std::size_t late = 0, early = 0, missed = 0, touching = 0;
                for (int i = 0; i < 25; ++i) {
                    const MovingConvex a = draw_moving(of_a, draw, 20, 60);
                    MovingConvex b = draw_moving(of_b, draw, 20, 60);
                    // Towards each other, fast.
                    const Vec2 d = a.centre - b.centre;
                    b.velocity += draw(0, 100) * (1 / std::sqrt(length_squared(d))) * d;
                    const ConvexImpact impact = impact_time(a, b, kDt, kTarget);
                    double least = 1e300, first = 2 * kDt;
                    const auto apart = [&](double time) {
                        return signed_distance(outline_of(at_time(a, time)), outline_of(at_time(b, time)));
                    };
                    for (int k = 0; k <= kSteps; ++k) {
                        const double time = kDt * k / kSteps, distance = apart(time);
                        if (time <= impact.time) least = std::fmin(least, distance);
                        if (distance <= 0.5 * kTarget && first > kDt) first = time;
                        if (time > impact.time && time > first) break;
                    }
                    touching += impact.touches;
                    if (impact.time > 0) late += least < 0.45 * kTarget;
                    missed += !impact.touches && first <= kDt;
                    late += impact.touches && impact.time > first;
                    early += impact.touches && impact.distance > kTarget;
                }
                CAPTURE(static_cast<int>(of_a));
                CAPTURE(static_cast<int>(of_b));
                CHECK(touching > 1);
                CHECK(late == 0);
                CHECK(missed == 0);
                CHECK(early == 0);
            }
    }

    TEST_CASE("a rod that turns by more than a quarter does not pass through a post") {
        MovingConvex rod{make_convex_shape<double>({{-1, -0.01}, {1, -0.01}, {1, 0.01}, {-1, 0.01}}, 0),
                         {0, 0},
                         {0, 0},
                         0,
                         150};
        const MovingConvex post{make_convex_shape<double>({{0, 0}}, 0.01), {0, 0.9}, {0, 0}, 0, 0};
        const ConvexImpact impact = impact_time(rod, post, 1.0 / 60, 1e-4);
        CHECK(impact.touches);
        // Its upper side comes to 0.01 m from the post's centre, 0.9 m from its own.
        CHECK(impact.time * 150 == doctest::Approx(1.570796 - std::asin(0.02 / 0.9)).epsilon(2e-4));
        CHECK(impact.normal.x == doctest::Approx(-1).epsilon(1e-3));
    }

    TEST_CASE("shapes that part or pass each other do not touch") {
        const ConvexShape<double> square = make_convex_shape<double>({{-1, -1}, {1, -1}, {1, 1}, {-1, 1}}, 0);
        const MovingConvex a{square, {0, 0}, {10, 0}, 0, 0};
        CHECK_FALSE(impact_time(a, {square, {3, 0}, {20, 0}, 0, 0}, 1, 1e-3).touches);
        CHECK_FALSE(impact_time(a, {square, {5, 2.01}, {-10, 0}, 0, 0}, 1, 1e-3).touches);
        const ConvexImpact hit = impact_time(a, {square, {5, 0}, {-10, 0}, 0, 0}, 1, 1e-3);
        CHECK(hit.touches);
        CHECK(hit.time == doctest::Approx(3.0 / 20).epsilon(1e-3));
        CHECK(impact_time(a, {square, {1.5, 0}, {0, 0}, 0, 0}, 1, 1e-3).time == 0);
    }
}

}  // namespace test_placed_convex

// Manifolds of convex shapes against supports of their vertices in double precision.
#include "support/convex_pairs.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>

#include <limits>

namespace test_find_manifolds {

using namespace carom;
using namespace carom::test;

namespace {

using enum ShapeKind;

struct PairClass {
    std::string name;
    ShapeKind a, b;
    double ratio;  // greatest, of sizes
    bool by_box_kernel = false;
};

const PairClass kClasses[] = {
    {"disc and disc", disc, disc, 4},
    {"disc and capsule", disc, capsule, 3},
    {"disc and polygon", disc, polygon, 3},
    {"capsule and capsule", capsule, capsule, 3},
    {"capsule and box", capsule, box, 3},
    {"capsule and octagon", capsule, octagon, 2},
    {"box and box", box, box, 2},
    {"box and rounded box", box, rounded_box, 2},
    {"rounded boxes", rounded_box, rounded_box, 3},
    {"triangles", triangle, triangle, 2},
    {"polygons", polygon, polygon, 2},
    {"octagons", octagon, octagon, 2},
    {"thin boxes", thin, thin, 2},
    {"thin box and polygon", thin, polygon, 2},
    {"boxes, by their own kernel", box, box, 2, true},
    {"thin boxes, by their own kernel", thin, thin, 2, true},
    {"boxes of very different size, by their own kernel", box, box, 300, true},
    {"polygons of very different size", polygon, polygon, 300},
};

template <class Real>
std::size_t find(ConvexPairs<Real>& pairs, const KernelTables& tables, bool by_box_kernel) {
    const ConvexKernels<Real>& kernels = *tables.of<Real>().convex;
    const auto kernel = by_box_kernel ? kernels.find_box_manifolds : kernels.find_manifolds;
    return kernel(pairs.arguments(), 0, padded(pairs.count()));
}

/// Where a point of a manifold is, by the levers about one of the bodies.
Vec2 place_of(const FoundManifold& m, const PlacedShape& body, const double* levers, double lever_t,
              int point) {
    const Vec2 tangent{-m.normal.y, m.normal.x};
    return body.centre + lever_t * m.normal + -levers[point] * tangent;
}

/// Round-off of lengths in a pair.
template <class Real>
double round_off(const PlacedShape& a, const PlacedShape& b) {
    double extent = a.radius + b.radius;
    for (const PlacedShape* shape : {&a, &b})
        for (const Vec2 v : shape->vertices)
            extent = std::fmax(extent, std::sqrt(length_squared(v - shape->centre)));
    return 40 * std::numeric_limits<Real>::epsilon() *
           (extent + std::sqrt(length_squared(a.centre)) + std::sqrt(length_squared(b.centre)));
}

}  // namespace

TEST_SUITE("kernels/find manifolds") {
    TEST_CASE_TEMPLATE(
        "the plane of a manifold has the gap of the shapes, and they are nowhere farther apart", Real, float,
        double) {
        for (const PairClass& kind : kClasses) {
            CAPTURE(kind.name);
            ConvexPairs<Real> pairs(
                static_cast<std::size_t>(scaled(sizeof(Real) == 4 ? 100'000 : 20'000, 2'000)));
            draw_pairs(pairs, kind.a, kind.b, kind.ratio, 7);
            find(pairs, *runnable_kernel_tables().back(), kind.by_box_kernel);
            std::size_t wrong_life = 0, bad_unit = 0, bad_gap = 0, bad_distance = 0, inexact = 0;
            std::size_t bad_place = 0, bad_between = 0, live = 0;
            for (std::size_t i = 0; i < pairs.count(); ++i) {
                const PlacedShape a = pairs.placed_a(i), b = pairs.placed_b(i);
                const FoundManifold m = pairs.found(i);
                const double distance = signed_distance(a, b), size = std::fmin(a.inradius, b.inradius);
                const double exact = round_off<Real>(a, b), allowed = 2e-3 * size + exact;
                if (std::fabs(distance - pairs.margin(i)) > allowed)
                    wrong_life += m.is_live() != (distance < pairs.margin(i));
                if (!m.is_live()) continue;
                ++live;
                const double separation = m.separation[m.lowest()];
                bad_unit +=
                    std::fabs(length_squared(m.normal) - 1) > 20 * std::numeric_limits<Real>::epsilon();
                bad_gap += std::fabs(gap_along(a, b, m.normal) - distance) > allowed;
                bad_distance += std::fabs(separation - distance) > allowed;
                inexact += std::fabs(separation - distance) > exact;
                const Vec2 of_a = place_of(m, a, m.lever_a, m.lever_a_t, m.lowest());
                const Vec2 of_b = place_of(m, b, m.lever_b, m.lever_b_t, m.lowest());
                bad_place += std::sqrt(length_squared(of_a - of_b)) > exact;
                // Half way between the surfaces; inside a polygon other edges may be nearer.
                for (const PlacedShape* shape : {&a, &b}) {
                    const double off = signed_distance(of_a, *shape) - separation / 2;
                    const bool is_inside = separation / 2 + shape->radius <= exact;
                    bad_between += off < -allowed || (!is_inside && off > allowed);
                }
            }
            CHECK(live > pairs.count() / 3);
            CHECK(wrong_life == 0);
            CHECK(bad_unit == 0);
            CHECK(bad_gap == 0);
            CHECK(bad_distance == 0);
            // The face of a has the reference where faces are nearly parallel; vertices that meet have none.
            CHECK(inexact < pairs.count() / 20);
            CHECK(bad_place == 0);
            CHECK(bad_between == 0);
        }
    }

    TEST_CASE_TEMPLATE("every instruction set finds the same bits, however many pairs there are", Real, float,
                       double) {
        for (const PairClass& kind : kClasses)
            for (const std::size_t count : {1u, 7u, 16u, 17u, 1000u}) {
                CAPTURE(kind.name);
                CAPTURE(count);
                ConvexPairs<Real> exact(count);
                draw_pairs(exact, kind.a, kind.b, kind.ratio, 11);
                find(exact, *runnable_kernel_tables().front(), kind.by_box_kernel);
                for (const KernelTables* tables : runnable_kernel_tables()) {
                    CAPTURE(tables->of<Real>().isa);
                    ConvexPairs<Real> pairs(count);
                    draw_pairs(pairs, kind.a, kind.b, kind.ratio, 11);
                    find(pairs, *tables, kind.by_box_kernel);
                    CHECK(pairs.equals(exact));
                    CHECK(pairs.is_rest_untouched());
                }
            }
    }

    TEST_CASE_TEMPLATE("the kernel of boxes finds what that of convex shapes finds", Real, float, double) {
        for (const ShapeKind kind : {box, thin}) {
            ConvexPairs<Real> general(20'000), boxes(20'000);
            draw_pairs(general, kind, kind, 3, 5), draw_pairs(boxes, kind, kind, 3, 5);
            find(general, *runnable_kernel_tables().back(), false);
            find(boxes, *runnable_kernel_tables().back(), true);
            std::size_t others = 0, live = 0, bad = 0;
            for (std::size_t i = 0; i < boxes.count(); ++i) {
                const FoundManifold m = boxes.found(i), n = general.found(i);
                const PlacedShape a = boxes.placed_a(i), b = boxes.placed_b(i);
                const double exact = round_off<Real>(a, b), size = std::fmin(a.inradius, b.inradius);
                if (!m.is_live() || !n.is_live()) continue;
                ++live;
                // Either of two faces that are as far away may be taken.
                if (std::sqrt(length_squared(m.normal - n.normal)) > 1e-3 || m.has_two() != n.has_two()) {
                    ++others;
                    bad +=
                        std::fabs(m.separation[m.lowest()] - n.separation[n.lowest()]) > 1e-3 * size + exact;
                    continue;
                }
                double worst = std::fabs(m.separation[0] - n.separation[0]);
                if (m.has_two()) worst = std::fmax(worst, std::fabs(m.separation[1] - n.separation[1]));
                for (int point = 0; point < 2; ++point)
                    worst = std::fmax(worst, std::fmax(std::fabs(m.lever_a[point] - n.lever_a[point]),
                                                       std::fabs(m.lever_b[point] - n.lever_b[point])));
                worst = std::fmax(worst, std::fabs(m.lever_a_t - n.lever_a_t));
                worst = std::fmax(worst, std::fabs(m.lever_b_t - n.lever_b_t));
                bad += worst > 100 * exact;
            }
            CHECK(live > boxes.count() / 3);
            CHECK(others < live / 10);  // of every 16th the centres coincide
            CHECK(bad == 0);
        }
    }
}

}  // namespace test_find_manifolds

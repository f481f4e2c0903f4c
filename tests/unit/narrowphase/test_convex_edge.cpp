// Convex shapes on walls and chains: what touches, where, and with which normal.
#include "narrowphase/convex_edge.hpp"

#include "support/convex_pairs.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <numeric>

namespace test_convex_edge {

using namespace carom;
using namespace carom::test;

namespace {

using enum ShapeKind;

constexpr ShapeKind kKinds[] = {disc, capsule, box, rounded_box, polygon, octagon, thin};

std::vector<Vec2> box_of(double half_width, double half_height) {
    return {{-half_width, -half_height},
            {half_width, -half_height},
            {half_width, half_height},
            {-half_width, half_height}};
}

PlacedConvex body_at(const ConvexShape<double>& shape, Vec2 centre, double angle) {
    return {shape, centre, rotation_by(angle)};
}

PlacedShape outline_of(const PlacedConvex& body) {
    const double pose[] = {body.centre.x, body.centre.y, body.turn.cos, body.turn.sin};
    return place(body.shape, pose);
}

struct Ground {
    std::vector<Edge> edges;
    std::vector<std::int32_t> all;

    explicit Ground(const std::vector<Vec2>& points) {
        const auto count = static_cast<std::int32_t>(points.size()) - 1;
        for (std::int32_t i = 0; i < count; ++i) {
            const auto at = static_cast<std::size_t>(i);
            edges.push_back({points[at], points[at + 1], 0, i - 1, i + 1 < count ? i + 1 : -1});
        }
        all.resize(edges.size());
        std::iota(all.begin(), all.end(), 0);
    }
    std::vector<ChainManifold> touching(const PlacedConvex& body, double margin) const {
        std::vector<ChainManifold> found;
        find_chain_manifolds(body, edges, all, margin, found);
        return found;
    }
};

/// Level at y = 0, from -6 to 6 m.
Ground level_chain(double length) {
    std::vector<Vec2> points;
    const int count = static_cast<int>(std::lround(12 / length));
    for (int i = 0; i <= count; ++i) points.push_back({-6 + length * i, 0});
    return Ground(points);
}

/// How far below the origin a body about it reaches, roundings included.
double depth_of(const PlacedConvex& body) {
    return -gap_along(outline_of(body), {{{0, 0}}, 0, {0, 0}, 0}, {0, -1});
}

double lowest_of(const Manifold<double>& m) {
    return std::fmin(m.separation1, m.separation2);
}

}  // namespace

TEST_SUITE("narrowphase/convex edge") {
    TEST_CASE("a shape on a wall has its lowest points there, and both bodies the same place") {
        Draw draw(3);
        const Vec2 walls[] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {0.6, -0.8}};
        for (const ShapeKind kind : kKinds)
            for (int i = 0; i < 400; ++i) {
                const Vec2 n = walls[draw.below(5)], point{draw(-1, 1), draw(-1, 1)};
                const double angle = i % 3 == 0 ? 1.5707963267948966 * draw(0, 4) : 0.5 * draw(-6, 6);
                const PlacedConvex body =
                    body_at(draw_shape<double>(kind, draw, draw(0.2, 1)), {draw(-2, 2), draw(-2, 2)}, angle);
                const Manifold<double> m = manifold_on_plane(body, n, point);
                CAPTURE(static_cast<int>(kind));
                CHECK(std::fabs(m.normal_x - n.x) + std::fabs(m.normal_y - n.y) < 1e-14);
                const double exact = gap_along(outline_of(body), {{point}, 0, point, 0}, n);
                CHECK(lowest_of(m) == doctest::Approx(exact).epsilon(1e-12));
                CHECK((m.separation2 >= kNoPoint || m.lever_a1 >= m.lever_a2));  // r x n = -(r . t)
                const Vec2 t{-n.y, n.x};
                const Vec2 by_a = body.centre + m.lever_a_t * n - m.lever_a1 * t;
                const Vec2 by_b = point + m.lever_b_t * n - m.lever_b1 * t;
                CHECK(length_squared(by_a - by_b) < 1e-24);
                CHECK(dot(by_a - point, n) == doctest::Approx(-exact / 2).epsilon(1e-9));
            }
    }

    TEST_CASE(
        "a box on a level chain has one manifold: its corners, and the chain's normal to the last bit") {
        const Ground chain = level_chain(0.1);
        const ConvexShape<double> shape = make_convex_shape<double>(box_of(0.5, 0.3), 0);
        for (const double side : {1.0, -1.0})
            for (int i = 0; i < 700; ++i) {
                const double x = -1 + 0.0017 * i, gap = 0.0005 * (i % 40 - 30);
                const auto found = chain.touching(
                    body_at(shape, {x, side * (0.3 + gap)}, side > 0 ? 0 : 3.141592653589793), 0.01);
                CAPTURE(x);
                CAPTURE(gap);
                REQUIRE(found.size() == 1);
                const Manifold<double>& m = found[0].manifold;
                CHECK(std::fabs(m.normal_x) < 1e-15);
                CHECK(m.normal_y == -side);
                CHECK(m.separation1 == doctest::Approx(gap).epsilon(1e-9));
                CHECK(m.separation2 == doctest::Approx(gap).epsilon(1e-9));
                // An edge's end that lies less far under the box than it is deep does not matter.
                const double slack = 1e-9 + std::fmax(0, -gap);
                CHECK(std::fabs(m.lever_a1 - 0.5) < slack);
                CHECK(std::fabs(m.lever_a2 + 0.5) < slack);
                CHECK(m.lever_b1 - m.lever_a1 == doctest::Approx(-side * x));
            }
    }

    TEST_CASE("whatever slides over joints of a level chain is never pushed sideways") {
        const Ground chain = level_chain(0.1);
        Draw draw(17);
        for (const ShapeKind kind : kKinds)
            for (int i = 0; i < 600; ++i) {
                const double gap = draw(-0.02, 0.02);
                PlacedConvex body = body_at(draw_shape<double>(kind, draw, draw(0.2, 1)), {draw(-1, 1), 0},
                                            i % 4 == 0 ? 1e-3 * draw(-1, 1) : draw(-3, 3));
                body.centre.y = depth_of(body) + gap;
                CAPTURE(static_cast<int>(kind));
                CAPTURE(i);
                if (0.05 + std::fmax(0, -gap) > body.shape.inradius) continue;
                const auto found = chain.touching(body, 0.05);
                REQUIRE(found.size() == 1);
                CHECK(std::fabs(found[0].manifold.normal_x) < 1e-14);
                CHECK(found[0].manifold.normal_y < 0);
                CHECK(lowest_of(found[0].manifold) == doctest::Approx(gap).epsilon(1e-9));
            }
    }

    TEST_CASE(
        "a shape of few vertices has the contacts, to the last bit, of one that repeats its last vertex") {
        Draw draw(37);
        const auto same = [](const ChainManifold& l, const ChainManifold& r) {
            return l.edge == r.edge && std::memcmp(&l.manifold, &r.manifold, sizeof(l.manifold)) == 0;
        };
        for (const ShapeKind kind : {capsule, box, rounded_box, triangle, polygon, thin}) {
            std::size_t several = 0, single = 0;
            for (int i = 0; i < 1500; ++i) {
                std::vector<Vec2> points;
                const double rough = draw(0, 0.2);
                for (int k = 0; k <= 12; ++k) points.push_back({-3 + 0.5 * k, draw(-rough, rough)});
                const Ground chain(points);
                const PlacedConvex few = body_at(draw_shape<double>(kind, draw, draw(0.1, 0.8)),
                                                 {draw(-2, 2), draw(-0.1, 0.9)}, draw(-3, 3));
                PlacedConvex many = few;
                many.shape.count = kMostVertices;
                const double margin = draw(0, 0.2);
                const auto found = chain.touching(few, margin);
                REQUIRE(std::ranges::equal(found, chain.touching(many, margin), same));
                several += found.size() > 1, single += found.size() == 1;
            }
            CAPTURE(static_cast<int>(kind));
            CHECK(several > 20);
            CHECK(single > 50);
        }
    }

    TEST_CASE("a box that hangs over a ledge is not pushed back by the face of the ledge") {
        const Ground ledge({{-2, 0}, {-1, 0}, {0, 0}, {0, -1}, {0, -2}});
        const ConvexShape<double> shape = make_convex_shape<double>(box_of(0.5, 0.3), 0);
        for (const double gap : {-0.01, -0.001, 0.0, 0.001, 0.01})
            for (double x = -0.9; x < 0.48; x += 0.013) {
                const auto found = ledge.touching(body_at(shape, {x, 0.3 + gap}, 0), 0.02);
                CAPTURE(gap);
                CAPTURE(x);
                REQUIRE(found.size() == 1);
                const Manifold<double>& m = found[0].manifold;
                CHECK(std::fabs(m.normal_x) < 1e-12);
                CHECK(m.separation1 == doctest::Approx(gap).epsilon(1e-9));
                CHECK(m.lever_a1 == doctest::Approx(0.5));
                CHECK(m.lever_a2 == doctest::Approx(-std::fmin(0.5, -x)).epsilon(0.02));
            }
    }

    TEST_CASE("at the ridge of a roof the edge that is nearer to parallel pushes, and alone") {
        const double slope = 0.25;
        const Ground roof({{-2, -2 * slope}, {0, 0}, {2, -2 * slope}});
        const ConvexShape<double> shape = make_convex_shape<double>(box_of(0.5, 0.3), 0);
        for (int i = -20; i <= 20; ++i) {
            const double angle = 0.0105 * i;
            if (i == 0) continue;
            const Rotation turn = rotation_by(angle);
            const PlacedConvex body = body_at(shape, rotate(turn, {0, 0.299}), angle);
            const auto found = roof.touching(body, 0.005);
            CAPTURE(angle);
            REQUIRE(found.size() == 1);
            CHECK(found[0].edge == (angle > 0 ? 0 : 1));  // turned to the left it lies along the left side
            CHECK(found[0].manifold.normal_x == doctest::Approx(turn.sin));
            CHECK(lowest_of(found[0].manifold) == doctest::Approx(-0.001));
        }
    }

    TEST_CASE("a box in a corner touches the floor and the wall") {
        const Ground corner({{-2, 0}, {-1, 0}, {0, 0}, {0, 1}, {0, 2}});
        const ConvexShape<double> shape = make_convex_shape<double>(box_of(0.5, 0.3), 0);
        for (const double gap : {-0.01, 0.0, 0.004}) {
            const auto found = corner.touching(body_at(shape, {-0.5 - gap, 0.3 + 0.5 * gap}, 0), 0.01);
            REQUIRE(found.size() == 2);
            CHECK(found[0].manifold.normal_y == doctest::Approx(-1));
            CHECK(lowest_of(found[0].manifold) == doctest::Approx(0.5 * gap));
            CHECK(found[1].manifold.normal_x == doctest::Approx(1));
            CHECK(lowest_of(found[1].manifold) == doctest::Approx(gap));
        }
    }

    TEST_CASE("a free end of a segment pushes along the line of nearest points") {
        const Ground segment({{0, 0}, {1, 0}});
        const ConvexShape<double> shape = make_convex_shape<double>(box_of(0.5, 0.3), 0);
        const auto found = segment.touching(body_at(shape, {1.49, 0.1}, 0), 0.02);
        REQUIRE(found.size() == 1);
        CHECK(found[0].manifold.normal_x == doctest::Approx(-1));
        CHECK(lowest_of(found[0].manifold) == doctest::Approx(-0.01));
    }

    TEST_CASE("no contact of a rough chain is missed, and none is nearer than the chain") {
        Draw draw(29);
        for (const ShapeKind kind : kKinds) {
            std::size_t near = 0, missed = 0, too_near = 0, not_parting = 0;
            for (int i = 0; i < 1500; ++i) {
                std::vector<Vec2> points;
                for (int k = 0; k <= 24; ++k) points.push_back({-3 + 0.25 * k, draw(-0.2, 0.2)});
                const Ground chain(points);
                PlacedConvex body = body_at(draw_shape<double>(kind, draw, draw(0.2, 0.6)),
                                            {draw(-1, 1), draw(0.2, 0.9)}, draw(-3, 3));
                const auto distance = [&](const Edge& edge) {
                    return signed_distance(outline_of(body), {{edge.a, edge.b}, 0, edge.a, 0});
                };
                double nearest = 1e300;
                for (const Edge& edge : chain.edges) nearest = std::fmin(nearest, distance(edge));
                if (nearest < 1e-3 || nearest > 0.1) continue;
                ++near;
                const auto found = chain.touching(body, 0.1);
                double least = 1e300;
                for (const ChainManifold& each : found) {
                    least = std::fmin(least, lowest_of(each.manifold));
                    const Edge& edge = chain.edges[static_cast<std::size_t>(each.edge)];
                    const Vec2 n{each.manifold.normal_x, each.manifold.normal_y};
                    not_parting += gap_along(outline_of(body), {{edge.a, edge.b}, 0, edge.a, 0}, n) < -1e-6 &&
                                   lowest_of(each.manifold) > distance(edge) + 1e-3;
                }
                missed += least > nearest + 2e-3 * body.shape.inradius;
                too_near += least < nearest - 1e-9;
            }
            CAPTURE(static_cast<int>(kind));
            CHECK(near > 60);
            CHECK(missed == 0);
            CHECK(too_near == 0);
            CHECK(not_parting == 0);
        }
    }

    TEST_CASE(
        "what has sunk into a rough chain a little is pushed out of it, and by no more than it has sunk") {
        Draw draw(31);
        for (const ShapeKind kind : {disc, capsule, box, rounded_box, polygon, octagon}) {
            std::size_t sunk = 0, missed = 0, too_deep = 0, downwards = 0;
            for (int i = 0; i < 2000; ++i) {
                std::vector<Vec2> points;
                for (int k = 0; k <= 24; ++k) points.push_back({-3 + 0.25 * k, draw(-0.05, 0.05)});
                const Ground chain(points);
                const PlacedConvex body = body_at(draw_shape<double>(kind, draw, draw(0.2, 0.6)),
                                                  {draw(-1, 1), draw(0.1, 0.8)}, draw(-3, 3));
                double deepest = 1e300;
                for (const Edge& edge : chain.edges)
                    deepest = std::fmin(deepest,
                                        signed_distance(outline_of(body), {{edge.a, edge.b}, 0, edge.a, 0}));
                if (deepest > 0 || deepest < -0.1 * body.shape.inradius) continue;
                ++sunk;
                double least = 1e300;
                for (const ChainManifold& each : chain.touching(body, 0.01)) {
                    least = std::fmin(least, lowest_of(each.manifold));
                    downwards += each.manifold.normal_y > 0;
                }
                missed += least > 0.5 * deepest;
                too_deep += least < 2 * deepest - 1e-3;
            }
            CAPTURE(static_cast<int>(kind));
            CHECK(sunk > 40);
            CHECK(missed == 0);
            CHECK(too_deep == 0);
            CHECK(downwards == 0);
        }
    }
}

}  // namespace test_convex_edge

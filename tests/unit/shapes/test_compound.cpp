// Mass properties of compounds against closed forms, and where their pieces come to lie.
#include <doctest/doctest.h>

#include <carom/carom.hpp>

#include <cmath>
#include <numbers>

#include "shapes/compound.hpp"
#include "shapes/convex_geometry.hpp"

namespace test_compound {

using namespace carom;

namespace {

constexpr double kRound = 1e-13;

Piece box(double width, double height, Vec2 at, double angle = 0) {
    return {.shape = Box{width, height}, .position = at, .angle = angle};
}

double near(double value, double expected) {
    return std::abs(value - expected) / std::max(1.0, std::abs(expected));
}

}  // namespace

TEST_SUITE("shapes: compounds") {
    TEST_CASE("an L of two boxes has the mass, centre and inertia of the closed form") {
        // A bar of 3 x 1 along x and one of 1 x 2 on its left end: the L within (0, 0), (3, 3).
        const Compound l{{box(3, 1, {1.5, 0.5}), box(1, 2, {0.5, 2})}};
        const MassProperties of = mass_properties_of(l);
        CHECK(near(of.area, 5) < kRound);
        CHECK(near(of.centroid.x, (3 * 1.5 + 2 * 0.5) / 5) < kRound);
        CHECK(near(of.centroid.y, (3 * 0.5 + 2 * 2) / 5) < kRound);
        // The square of 3 less the square of 2 in its corner, about the origin, less Steiner's term.
        const double about_origin = 2 * 81.0 / 3 - (4 * (8.0 / 12 + 2 * 2.0 * 2.0));
        CHECK(near(of.second_moment, about_origin - 5 * (of.centroid.x * of.centroid.x +
                                                         of.centroid.y * of.centroid.y)) < kRound);
    }

    TEST_CASE("a dumbbell of two discs and a light rod: reduced mass, and discs on their own axes") {
        const double r = 0.5, half = 1.5, heavy = 3;
        Compound dumbbell{
            {{.shape = Disc{r}, .position = {-half, 0}, .material = Material{.density = 1}},
             {.shape = Disc{r}, .position = {half, 0}, .material = Material{.density = heavy}}}};
        const Body body{.shape = dumbbell};
        const BodyMass of = body_mass_of(body);
        const double disc = std::numbers::pi * r * r, m1 = disc, m2 = heavy * disc;
        CHECK(near(of.mass, m1 + m2) < kRound);
        CHECK(near(of.centre.x, half * (m2 - m1) / (m1 + m2)) < kRound);
        CHECK(near(of.inertia, (m1 + m2) * r * r / 2 + m1 * m2 / (m1 + m2) * 4 * half * half) < kRound);
        Body given = body;
        given.mass = 7;
        CHECK(near(body_mass_of(given).inertia, of.inertia * 7 / of.mass) < kRound);
    }

    TEST_CASE("a square cut into four turned pieces is the square") {
        // Triangles from the middle to the sides: polygons stay where their vertices are.
        Compound square;
        for (int i = 0; i < 4; ++i)
            square.pieces.push_back({.shape = Polygon{{{0, 0}, {1, -1}, {1, 1}}},
                                     .position = {5, -2},
                                     .angle = i * std::numbers::pi / 2});
        const MassProperties cut = mass_properties_of(square), whole = mass_properties_of(Box{2, 2});
        CHECK(near(cut.area, whole.area) < kRound);
        CHECK(near(cut.centroid.x, 5) < kRound);
        CHECK(near(cut.centroid.y, -2) < kRound);
        CHECK(near(cut.second_moment, whole.second_moment) < 1e-12);
    }

    TEST_CASE(
        "recentred, the centre of mass is the origin and every point is where it was against the others") {
        const Compound given{{box(1, 2, {3, 4}, 0.3),
                              {.shape = Polygon{{{0, 0}, {2, 0}, {0, 1}}}, .position = {2, 3}, .angle = -1}}};
        const Compound found = recentred(given);
        const MassProperties of = mass_properties_of(found), before = mass_properties_of(given);
        CHECK(std::abs(of.centroid.x) < 1e-14);
        CHECK(std::abs(of.centroid.y) < 1e-14);
        CHECK(near(of.second_moment, before.second_moment) < kRound);
        // A vertex of the triangle, from both.
        const auto vertex = [](const Piece& piece) {
            const Vec2 v = std::get<Polygon>(piece.shape).vertices[1];
            const double c = std::cos(piece.angle), s = std::sin(piece.angle);
            return Vec2{piece.position.x + c * v.x - s * v.y, piece.position.y + s * v.x + c * v.y};
        };
        const Vec2 moved = vertex(found.pieces[1]) + before.centroid, first = vertex(given.pieces[1]);
        CHECK(near(moved.x, first.x) < kRound);
        CHECK(near(moved.y, first.y) < kRound);
    }

    TEST_CASE("a world has the mass and the inertia of the sum: a blow turns it as the closed form says") {
        Scene scene;
        const Compound cross{{box(3, 1, {}), box(1, 1, {0, 1}), box(1, 1, {0, -1})}};
        const BodyId id = scene.add({.shape = cross, .angular_velocity = 2, .material = {.density = 2}});
        World64 world(scene);
        const double inertia = 2 * (3 * 10.0 / 12 + 2 * (2.0 / 12 + 1));
        CHECK(near(world.ledger().energy.rotational, 0.5 * inertia * 4) < 1e-12);
        const auto found = std::get<Compound>(world.shape(id));
        REQUIRE(found.pieces.size() == 3);
        CHECK(found.pieces[1].position == Vec2{0, 1});
        CHECK(std::get<Box>(found.pieces[0].shape).width == 3);
        CHECK(found.pieces[0].material->density == 2);
    }

    TEST_CASE("bodies of the same compound share one geometry; others of the same pieces elsewhere do not") {
        Scene scene;
        const Compound l{{box(3, 1, {1.5, 0.5}), box(1, 2, {0.5, 2})}},
            other{{box(3, 1, {1.5, 0.5}), box(1, 2, {1.5, 2})}};
        for (int i = 0; i < 5; ++i) scene.add({.shape = l, .position = {10.0 * i, 0}});
        World world(scene);
        const std::size_t of_one = world.plan().shapes;
        CHECK(of_one == 3);  // the compound and its two pieces
        const BodyId added = world.add({.shape = other, .position = {0, 50}});
        CHECK(world.plan().shapes == 6);
        CHECK(world.add({.shape = l, .position = {0, 100}, .material = {.friction = 1}}).index == 6);
        CHECK(world.plan().shapes == 9);
        world.remove(added);
        CHECK(world.plan().shapes == 6);
    }

    TEST_CASE("what a compound cannot be is refused where it stands") {
        const auto pointer_of = [](const Compound& compound) {
            Scene scene;
            scene.add({.shape = Disc{1}});
            scene.add({.shape = compound, .position = {10, 0}});
            const auto found = scene.find_problem();
            return found ? found->pointer : std::string("none");
        };
        CHECK(pointer_of({{box(1, 1, {})}}) == "none");
        CHECK(pointer_of({}) == "/bodies/1/shape/compound/shapes");
        CHECK(pointer_of({{box(1, 1, {}), box(1, -1, {})}}) ==
              "/bodies/1/shape/compound/shapes/1/shape/box/height");
        CHECK(pointer_of({{box(1, 1, {NAN, 0})}}) == "/bodies/1/shape/compound/shapes/0/position/0");
        Compound rough{{box(1, 1, {})}};
        rough.pieces[0].material = Material{.friction = -1};
        CHECK(pointer_of(rough) == "/bodies/1/shape/compound/shapes/0/material/friction");
        CHECK(pointer_of({{box(0.001, 0.001, {}), box(0.001, 0.001, {5, 0})}}) ==
              "/bodies/1/shape/compound/shapes");
        CHECK(pointer_of({std::vector<Piece>(257)}) == "/bodies/1/shape/compound/shapes");
    }
}

}  // namespace test_compound

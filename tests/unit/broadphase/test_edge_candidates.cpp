#include "broadphase/edge_candidates.hpp"

#include "isa/select_isa.hpp"
#include "narrowphase/disc_edge.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>
#include <utility>

namespace test_edge_candidates {

using namespace carom;

namespace {

template <class Real>
struct Place {
    WorldState<Real> world;
    Candidates<Real> candidates;
    EdgeCandidates<Real> edges;

    void find(double dt) {
        candidates.prepare(world.bodies.count);
        candidates.invalidate();
        candidates.update(world.bodies, flight_clock_at(dt, 0), {}, {}, 4, select_kernels("auto").of<Real>(),
                          Executor(1));
        edges.place(world, dt);
        edges.find(world, candidates);
    }
};

/// Discs of radius `smallest` to 1 over 60 m, segments and chains of all lengths among them.
template <class Real>
Place<Real> random_place(std::uint32_t seed, double smallest) {
    std::mt19937 random(seed);
    const auto uniform = [&](double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(random);
    };
    Place<Real> place;
    place.world.bodies.has_rotation = true;
    const auto point = [&] { return Vec2{uniform(-30, 30), uniform(-30, 30)}; };
    for (int i = 0; i < 6; ++i) {
        Body line{.type = BodyType::kinematic_body, .position = point(), .angle = uniform(-3, 3)};
        if (i < 3) line.velocity = {uniform(-1, 1), uniform(-1, 1)}, line.angular_velocity = uniform(-2, 2);
        if (i % 2 == 0)
            line.shape = Segment{{0, 0}, {std::pow(4.0, i), 1}};
        else
            line.shape = Chain{.points = {{0, 0}, {1, 0}, {20, 0}, {20, 20}}, .loop = i == 3};
        place.world.append(line);
    }
    for (int i = 0; i < 700; ++i)
        place.world.append({.shape = Disc{uniform(smallest, 1)}, .position = point(), .velocity = {1, 0}});
    return place;
}

}  // namespace

TEST_SUITE("broadphase/edge_candidates") {
    TEST_CASE_TEMPLATE("they are those of brute force, for edges of all lengths and discs of all sizes", Real,
                       float, double) {
        for (const double smallest : {1.0, 0.3, 0.001}) {
            Place<Real> place = random_place<Real>(3, smallest);
            place.find(1.0 / 60);
            const auto found = place.edges.pairs();
            std::set<std::pair<std::int32_t, std::int32_t>> pairs;
            for (const EdgePair pair : found) pairs.insert({pair.row, pair.edge});
            CHECK(pairs.size() == found.size());  // none twice
            CHECK(std::is_sorted(found.begin(), found.end()));
            std::size_t expected = 0;
            for (std::int32_t e = 0; e < static_cast<std::int32_t>(place.world.edges.edges.size()); ++e)
                for (std::size_t row = 0; row < place.world.bodies.count; ++row) {
                    if (place.world.bodies.is_immovable(row)) continue;
                    const Edge& edge = place.world.edges[e];
                    const EdgePose& pose = place.edges.pose_of(edge);
                    const Vec2 x{place.world.bodies.position_x[row], place.world.bodies.position_y[row]};
                    const double distance = std::sqrt(
                        distance_squared(rotate_back(pose.turn, x - pose.position), edge.a, edge.b));
                    const double reach = place.candidates.reach()[row];
                    const bool is_found = pairs.contains({static_cast<std::int32_t>(row), e});
                    if (distance < reach) {
                        CHECK(is_found);
                        ++expected;
                    } else if (is_found) {
                        CHECK(distance < reach + 4.6);  // no more than the largest margins there are
                    }
                }
            CHECK(expected > 20);
        }
    }

    TEST_CASE("they come by row, then by edge, few and many") {
        for (const double length : {1.0, 200.0}) {
            Place<double> place;
            Body chain{.type = BodyType::static_body, .position = {-0.25, 0.25}};
            chain.shape = Chain{.points = {{0, 0}, {0.5 * length, 0}, {length, 0}}};
            place.world.append(chain);
            for (int i = 0; i < 800; ++i)
                place.world.append(
                    {.shape = Disc{0.4}, .position = {static_cast<double>(i * 37 % 200), i % 2 * 60.0}});
            place.find(1.0 / 60);
            const auto found = place.edges.pairs();
            CHECK(std::is_sorted(found.begin(), found.end()));
            if (length > 1)
                CHECK(found.size() > 380);
            else
                CHECK((found.size() > 0 && found.size() < 20));
        }
    }

    TEST_CASE("the margin of a moving edge is used up by its motion, and not before") {
        Place<double> place = random_place<double>(4, 0.5);
        place.find(1.0 / 60);
        CHECK_FALSE(place.edges.has_left_margin(place.world));
        Bodies<double>& bodies = place.world.bodies;
        int steps = 0;
        for (; steps < 1000 && !place.edges.has_left_margin(place.world); ++steps) {
            for (std::size_t row = 0; row < 6; ++row) {
                bodies.position_x[row] += bodies.velocity_x[row] / 60;
                bodies.position_y[row] += bodies.velocity_y[row] / 60;
                bodies.angle[row] += bodies.angular_velocity[row] / 60;
            }
            place.edges.place(place.world, 1.0 / 60);
        }
        CHECK(steps >= 1);
        CHECK(steps < 1000);
    }
}

}  // namespace test_edge_candidates

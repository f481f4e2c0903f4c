// Places that drift with the flow of their bodies. What pairs make of them: test_own_margins.cpp.
#include "broadphase/moving_places.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <vector>

#include "math/vec2_math.hpp"

namespace test_moving_places {

using namespace carom;

namespace {

constexpr std::size_t kCount = 100;
constexpr double kStep = 1.0 / 64, kRadius = 0.5;
constexpr Vec2 kVelocity{3, -1};  // m/s

/// A lattice of discs that fly side by side.
Bodies<double> flock(Vec2 velocity) {
    Bodies<double> bodies;
    bodies.resize(kCount);
    for (std::size_t row = 0; row < kCount; ++row) {
        bodies.position_x[row] = static_cast<double>(row % 10),
        bodies.position_y[row] = static_cast<double>(row / 10);
        bodies.velocity_x[row] = velocity.x, bodies.velocity_y[row] = velocity.y;
        bodies.radius.set(row, kCount, kRadius);
    }
    return bodies;
}

struct Places {
    Bodies<double> bodies;
    MovingPlaces<double> places;
    Column<double> reach;

    explicit Places(Vec2 velocity) : bodies(flock(velocity)) {
        reach.resize(kCount);
        for (std::size_t row = 0; row < kCount; ++row) reach[row] = 2 * kRadius;
        places.begin(bodies, kCount, {kRadius, 2 * kRadius}, flight_clock_at(kStep, 0), {}, Executor());
        places.note_reach(2 * kRadius);
    }
    bool move() { return places.move(bodies, kStep, HUGE_VAL, reach, Executor()); }
    Vec2 start(std::size_t row) const { return {bodies.position_x[row], bodies.position_y[row]}; }
};

double distance(Vec2 a, Vec2 b) {
    return std::sqrt(length_squared(b - a));
}

}  // namespace

TEST_SUITE("broadphase/moving places") {
    TEST_CASE("places go where a flock flies until they have drifted as far as they may") {
        Places flock(kVelocity);
        const double speed = std::sqrt(length_squared(kVelocity));
        const int steps = static_cast<int>(flock.places.largest_drift() / (speed * kStep));
        REQUIRE(steps > 10);
        for (int step = 1; step <= steps; ++step) {
            REQUIRE(flock.move());
            const Vec2 way = step * kStep * kVelocity;
            CHECK(flock.places.largest_drift_so_far() == doctest::Approx(step * kStep * speed));
            for (const std::size_t row : {std::size_t{0}, kCount / 2, kCount - 1}) {
                CHECK(distance(flock.places.place(row), flock.start(row) + way) < 1e-12);
                CHECK(distance(flock.places.drift_of(row), way) < 1e-12);
                CHECK(flock.reach[row] == doctest::Approx(2 * kRadius).epsilon(1e-12));  // nothing closes
            }
        }
        CHECK(flock.places.spread() < 1e-12);
        CHECK_FALSE(flock.move());
    }

    TEST_CASE("where bodies rest, places stay and pairs last") {
        Places still({});
        for (int step = 0; step < 1000; ++step) REQUIRE(still.move());
        CHECK(still.places.place(7) == still.start(7));
        CHECK(still.places.largest_drift_so_far() == 0);
    }

    TEST_CASE("a place that is put goes on with the flow there") {
        Places flock(kVelocity);
        for (int step = 0; step < 5; ++step) REQUIRE(flock.move());
        const Vec2 at{4.25, 4.75};
        flock.places.put(33, at, kStep);
        CHECK(distance(flock.places.place(33), at + kStep * kVelocity) < 1e-12);
        REQUIRE(flock.move());
        CHECK(distance(flock.places.place(33), at + 2 * kStep * kVelocity) < 1e-12);
    }

    TEST_CASE("places go with their bodies when rows change, loose ones begin where their bodies are") {
        Places flock(kVelocity);
        for (int step = 0; step < 5; ++step) REQUIRE(flock.move());
        const Vec2 last = flock.places.place(kCount - 1), drift = flock.places.drift_of(kCount - 1);
        // The body of row 20 goes, the last one takes its place, and another comes.
        std::vector<std::int32_t> now(kCount);
        for (std::size_t row = 0; row < kCount; ++row) now[row] = static_cast<std::int32_t>(row);
        now[20] = -1, now[kCount - 1] = 20;
        RowNames names;
        CHECK(names.follow(kCount, now, std::vector<std::uint8_t>(kCount, 0)) == 1);
        flock.places.follow_rows(names, flock.bodies);
        CHECK(flock.places.place(20) == last);
        CHECK(flock.places.drift_of(20) == drift);
        CHECK(flock.places.place(kCount - 1) == flock.start(kCount - 1));
        CHECK(flock.places.drift_of(kCount - 1) == Vec2{});
        CHECK(flock.places.velocity(kCount - 1) == Vec2{});
    }
}

}  // namespace test_moving_places

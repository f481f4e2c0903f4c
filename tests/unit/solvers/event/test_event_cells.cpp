#include "solvers/event/event_cells.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace test_event_cells {

using namespace carom;

TEST_SUITE("solvers/event/event_cells") {
    TEST_CASE("discs that touch are around each other, wherever they have gone, in boxes of any shape") {
        constexpr double kRadius = 0.5;
        constexpr std::size_t kDiscs = 300;
        std::mt19937 random(3);
        const auto uniform = [&](double low, double high) {
            return low + (high - low) * static_cast<double>(random()) / 4294967295.0;
        };
        for (const Vec2 box : {Vec2{18, 18}, Vec2{2000, 0.1}, Vec2{0.1, 2000}, Vec2{3, 3}, Vec2{1e5, 1e5}}) {
            CAPTURE(box.x);
            EventCells cells;
            cells.reset(kRadius, 0, box, kDiscs);
            std::vector<EventMover> movers(kDiscs);
            std::vector<Vec2> positions(kDiscs);
            for (std::size_t i = 0; i < kDiscs; ++i) {
                positions[i] = {uniform(-box.x, box.x), uniform(-box.y, box.y)};
                if (i % 3 == 1) positions[i] = positions[i - 1] + Vec2{uniform(-1, 1), uniform(-1, 1)};
                cells.insert(movers, static_cast<std::int32_t>(i), positions[i]);
            }
            std::int64_t touching = 0;
            for (int move = 0; move < 2000; ++move) {  // each disc goes where its cell ends, and on
                const std::size_t i = random() % kDiscs;
                const double angle = uniform(0, 6.28);
                const Vec2 velocity{std::cos(angle), std::sin(angle)};
                const EventCells::Exit exit = cells.find_exit(movers[i], positions[i], velocity, {});
                positions[i] += exit.after * velocity;
                cells.move(movers, static_cast<std::int32_t>(i), exit.side);
                const EventCells::Exit next = cells.find_exit(movers[i], positions[i], velocity, {});
                REQUIRE(next.after > 0);  // and not back at once
                std::vector<std::int32_t> around;
                cells.for_each_around(movers, movers[i].cell_x, movers[i].cell_y,
                                      [&](std::int32_t other) { around.push_back(other); });
                std::sort(around.begin(), around.end());
                REQUIRE(std::adjacent_find(around.begin(), around.end()) == around.end());
                for (std::size_t j = 0; j < kDiscs; ++j) {
                    const Vec2 d = positions[j] - positions[i];
                    if (std::hypot(d.x, d.y) > 2 * kRadius) continue;
                    ++touching;
                    REQUIRE(std::binary_search(around.begin(), around.end(), static_cast<std::int32_t>(j)));
                }
            }
            CHECK(touching > 2000);  // itself, and others
        }
    }

    TEST_CASE("a parabola leaves through the side it was thrown from, after 2 v / g and the margin") {
        EventCells cells;
        cells.reset(0.5, 10, {100, 100}, 100);
        std::vector<EventMover> movers(1);
        cells.insert(movers, 0, {5, 1});
        const auto up = cells.find_exit(movers[0], {5, 1}, {0, 4}, {0, -10});
        CHECK(up.side == 2);
        const double margin = 0.01 * cells.size();  // falls by 1 m and the margin below where it was thrown
        CHECK(up.after == doctest::Approx((4 + std::sqrt(16 + 20 * (1 + margin))) / 10).epsilon(1e-12));
        const auto through = cells.find_exit(movers[0], {5, 1}, {0, 40}, {0, -10});
        CHECK(through.side == 3);
    }

    TEST_CASE("the time of a fall to zero is the earlier root, and now if it is there and falling") {
        CHECK(fall_time(2, -1, 0) == 2);
        CHECK(fall_time(2, 1, 0) == kNever);
        CHECK(fall_time(0, -1, 3) == 0);
        CHECK(fall_time(-1e-18, -1, 0) == 0);
        CHECK(fall_time(5, 0, -10) == doctest::Approx(1).epsilon(1e-15));
        CHECK(fall_time(0, 5, -10) == doctest::Approx(1).epsilon(1e-15));
        CHECK(fall_time(4, -5, 2) == doctest::Approx(1).epsilon(1e-15));
        CHECK(fall_time(4, -3, 2) == kNever);                                       // turns round before
        CHECK(fall_time(1e-16, -1, -10) == doctest::Approx(1e-16).epsilon(1e-12));  // no cancellation
    }
}

}  // namespace test_event_cells

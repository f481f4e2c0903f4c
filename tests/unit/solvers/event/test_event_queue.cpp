#include "solvers/event/event_queue.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

namespace test_event_queue {

using namespace carom;

TEST_SUITE("solvers/event/event_queue") {
    TEST_CASE("the first of many changing times is the least of them, and of equal ones the lowest number") {
        std::mt19937 random(5);
        for (const std::size_t count : {1u, 2u, 7u, 8u, 9u, 63u, 64u, 65u, 500u, 4097u}) {
            CAPTURE(count);
            EventQueue queue;
            queue.reset(count);
            std::vector<double> times(count, std::numeric_limits<double>::infinity());
            CHECK(queue.first_time() == times[0]);
            for (int change = 0; change < 3000; ++change) {
                const std::size_t number = random() % count;
                times[number] = static_cast<double>(random() % 100);  // many are equal
                queue.set(number, times[number]);
                const auto least = std::min_element(times.begin(), times.end());
                REQUIRE(queue.first_time() == *least);
                REQUIRE(queue.first() == static_cast<std::size_t>(least - times.begin()));
            }
        }
    }
}

}  // namespace test_event_queue

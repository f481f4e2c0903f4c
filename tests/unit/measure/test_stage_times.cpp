#include "measure/stage_times.hpp"

#include <doctest/doctest.h>

namespace test_stage_times {

using namespace carom;
using namespace carom::measure;

TEST_SUITE("measure/stage times") {
    TEST_CASE("a stage that first ran in between is told by its own time, and so are those behind it") {
        Profile before, after;
        before.stages = {{"begin", 10, 1}, {"end", 10, 2}};
        after.stages = {{"begin", 12, 1.5}, {"impacts", 3, 8}, {"end", 12, 2.25}};
        const auto times = stage_times_between(before, after);
        REQUIRE(times.size() == 3);
        CHECK(times[1].name == "impacts");
        CHECK(time_of_stage(times, "begin").seconds == 0.5);
        CHECK(time_of_stage(times, "impacts").calls == 3);
        CHECK(time_of_stage(times, "impacts").seconds == 8);
        CHECK(time_of_stage(times, "end").calls == 2);
        CHECK(time_of_stage(times, "end").seconds == 0.25);
    }

    TEST_CASE("a stage that did not run in between is left out") {
        Profile before, after;
        before.stages = {{"begin", 10, 1}, {"impacts", 3, 8}};
        after.stages = {{"begin", 11, 2}, {"impacts", 3, 8}};
        const auto times = stage_times_between(before, after);
        CHECK(times.size() == 1);
        CHECK(time_of_stage(times, "impacts").calls == 0);
    }
}

}  // namespace test_stage_times

#include <doctest/doctest.h>

#include <cstddef>
#include <vector>

#include "measure/clocks.hpp"
#include "profiling/shared_loops.hpp"

namespace test_shared_loops {

using carom::ParallelFor;
using carom::tool::SharedLoops;

namespace {

void work_for(double seconds) {
    const double end = carom::measure::wall_seconds() + seconds;
    while (carom::measure::wall_seconds() < end) {
    }
}

}  // namespace

TEST_SUITE("tools") {
    TEST_CASE("loops that threads could share are timed task by task, as threads would share them") {
        constexpr double kTask = 1e-3;  // s
        SharedLoops loops;
        const ParallelFor parallel_for = loops.parallel_for();
        std::vector<std::size_t> order;
        parallel_for(8, [&](std::size_t task) {
            order.push_back(task);
            work_for(kTask);
        });
        CHECK(order == std::vector<std::size_t>{0, 1, 2, 3, 4, 5, 6, 7});
        const SharedLoops::Seconds even = loops.seconds();
        CHECK(even.tasks >= 8 * kTask);
        CHECK(even.inside >= even.tasks);
        CHECK(even.on_cores[0] >= 2 * kTask);               // 2 of 8 tasks to each of 4 cores
        CHECK(even.on_cores[1] >= kTask);                   // 1 task to each of 8 of 16
        CHECK(even.on_cores[1] <= even.on_cores[0]);        // a part of the same measured times
        CHECK(even.on_cores[2] == even.on_cores[1]);        // more cores than tasks gain nothing
        CHECK(even.on_cores[0] <= even.tasks - 6 * kTask);  // the other three cores' tasks are left out

        // One long task is what each number of cores waits for.
        parallel_for(64, [&](std::size_t task) { work_for(task == 5 ? 4 * kTask : 0); });
        const SharedLoops::Seconds uneven = loops.seconds() - even;
        for (const double seconds : uneven.on_cores) CHECK(seconds >= 4 * kTask);
        CHECK(uneven.on_cores[2] <= uneven.on_cores[0]);
        CHECK(uneven.on_cores[0] <= uneven.tasks);

        parallel_for(0, [](std::size_t) {});
        CHECK(loops.seconds().tasks == doctest::Approx(even.tasks + uneven.tasks));
    }
}

}  // namespace test_shared_loops

// Two threads on one processor do not wait for each other in each loop. As in a container that may use a part
// of one processor: OpenMP does not know, and its threads wait by looking again and again. It does so only
// where no more threads than processors were started, so this is a program of its own. Exits with 0 if few
// loops stalled.
#include <sched.h>

#include <chrono>
#include <cstdio>

#include "parallel/executor.hpp"

namespace {

/// Binds the program, and the threads that it will start, to the first processor that it may use.
bool bind_to_one_processor() {
    cpu_set_t all, one;
    if (sched_getaffinity(0, sizeof all, &all) != 0) return false;
    CPU_ZERO(&one);
    for (int i = 0; i < CPU_SETSIZE && CPU_COUNT(&one) == 0; ++i)
        if (CPU_ISSET(i, &all)) CPU_SET(i, &one);
    return sched_setaffinity(0, sizeof one, &one) == 0;
}

}  // namespace

int main() {
    if (!bind_to_one_processor()) {
        std::perror("the program cannot be bound to one processor");
        return 1;
    }
    // A loop takes microseconds, unless it waits for a thread that the processor does not run: then it takes
    // time slices of milliseconds. Few may, which tell that the machine is busy.
    constexpr int kLoops = 1000, kMostStalled = kLoops / 4;
    constexpr std::chrono::milliseconds kStall{1};
    int stalled = 0;
    const carom::Executor executor(2);
    for (int loop = 0; loop < kLoops; ++loop) {
        const auto start = std::chrono::steady_clock::now();
        executor.for_each_task(2, 10 * carom::kShortestParallelLoop, [](std::size_t) {});
        stalled += std::chrono::steady_clock::now() - start > kStall;
    }
    std::printf("%d of %d loops stalled; at most %d may\n", stalled, kLoops, kMostStalled);
    return stalled <= kMostStalled ? 0 : 1;
}

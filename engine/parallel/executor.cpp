#include "parallel/executor.hpp"

#if defined(_OPENMP)
#include <omp.h>
#endif

#include <algorithm>
#include <chrono>
#include <utility>

namespace carom {
namespace {

// A processor that other programs use can keep a finished thread waiting for whole time slices, some
// milliseconds, at the end of every loop. When the wait is this much longer than the work was, the next loops
// run on one thread, twice as many each time; results do not depend on it.
constexpr double kLongestWait = 100e-6;  // s, waking threads and small differences between chunks
constexpr double kLongestWaitOfWork = 4;
constexpr int kFewestLoopsAlone = 64;
constexpr int kMostLoopsAlone = 4096;

double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

int usable_threads(int wanted, bool embedding_program_has_threads) {
    if (embedding_program_has_threads) return wanted;
#if defined(_OPENMP)
    return wanted > 0 ? wanted : omp_get_max_threads();
#else
    return 1;
#endif
}

}  // namespace

Executor::Executor(int threads, ParallelFor parallel_for)
    : threads_(usable_threads(threads, static_cast<bool>(parallel_for))),
      parallel_for_(std::move(parallel_for)) {}

void Executor::run(std::size_t chunks, Call call) const {
    if (parallel_for_) {
        parallel_for_(chunks, [call](std::size_t c) { call.invoke(call.function, c); });
        return;
    }
    const auto run_alone = [&] {
        for (std::size_t c = 0; c < chunks; ++c) call.invoke(call.function, c);
    };
#if defined(_OPENMP)
    if (loops_alone_ > 0) {
        --loops_alone_;
        run_alone();
        return;
    }
    const auto count = static_cast<std::ptrdiff_t>(chunks);
    const double start = seconds_now();
    double own_end = start;
#pragma omp parallel num_threads(threads_)
    {
#pragma omp for schedule(static) nowait
        for (std::ptrdiff_t c = 0; c < count; ++c) call.invoke(call.function, static_cast<std::size_t>(c));
#pragma omp master
        own_end = seconds_now();
    }
    const double waited = seconds_now() - own_end;
    const bool too_long = waited > kLongestWait + kLongestWaitOfWork * (own_end - start);
    loops_next_time_ = too_long ? std::min(2 * loops_next_time_, kMostLoopsAlone)
                                : std::max(loops_next_time_ / 2, kFewestLoopsAlone);
    if (too_long) loops_alone_ = loops_next_time_;
#else
    run_alone();
#endif
}

}  // namespace carom

#include "parallel/executor.hpp"

#if defined(_OPENMP)
#include <omp.h>
#endif

#include <algorithm>
#include <exception>
#include <utility>

#include "parallel/shared_tasks.hpp"
#include "parallel/waiting.hpp"

namespace carom {
namespace {

// A processor that other programs use can keep a finished thread waiting for whole time slices, some
// milliseconds, at the end of every loop. When the wait is this much longer than the work was, the next loops
// run on one thread, twice as many each time; results do not depend on it. The same goes for the wait at the
// end of a step for threads that stand by.
constexpr double kLongestWait = 100e-6;  // s, waking threads and small differences between chunks
constexpr double kLongestWaitOfWork = 4;
constexpr int kFewestLoopsAlone = 64;
constexpr int kMostLoopsAlone = 4096;
constexpr int kForgetting = 1024;  // loops without such a wait in which most of that is forgotten

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
      parallel_for_(std::move(parallel_for)),
      host_loop_(parallel_for_ ? std::make_unique<HostLoop>() : nullptr) {}

void Executor::rethrow_host_error() const {
    if (host_error_) std::rethrow_exception(std::exchange(host_error_, nullptr));
}

/// Whether the machine has been too busy of late for more than one thread.
bool Executor::is_left_alone() const {
    if (loops_alone_ == 0) return false;
    --loops_alone_;
    return true;
}

/// @param waited, worked  s, of the caller's thread in one loop
void Executor::note_wait(double waited, double worked) const {
    const bool too_long = waited > kLongestWait + kLongestWaitOfWork * worked;
    loops_next_time_ = too_long
                           ? std::min(2 * loops_next_time_, kMostLoopsAlone)
                           : std::max(loops_next_time_ - (loops_next_time_ + kForgetting - 1) / kForgetting,
                                      kFewestLoopsAlone);
    if (too_long) loops_alone_ = loops_next_time_;
}

void Executor::run_step(TeamCall work) const {
    struct Alone {
        bool& is_alone;
        explicit Alone(bool& flag) : is_alone(flag) { is_alone = true; }
        ~Alone() { is_alone = false; }
    };
    const double start = seconds_now();
    if (trial_.uses_threads()) {
        gather_team(work);
    } else {
        const Alone alone(is_alone_);
        work.invoke(work.function);
    }
    trial_.note(seconds_now() - start);
}

void Executor::gather_team(TeamCall work) const {
#if defined(_OPENMP)
    team_.gather(static_cast<std::size_t>(threads_));
    std::exception_ptr error;
    const double start = seconds_now();
    double begun = start, done = start;
#pragma omp parallel num_threads(threads_)
    {
        const auto thread = static_cast<std::size_t>(omp_get_thread_num());
        if (thread > 0) {
            team_.stand_by(thread);
        } else {
            begun = seconds_now();
            team_.begin(static_cast<std::size_t>(omp_get_num_threads()));
            try {
                work.invoke(work.function);
            } catch (...) {
                error = std::current_exception();
            }
            team_.dismiss();
            done = seconds_now();
        }
    }
    note_wait(begun - start + (seconds_now() - done), done - begun);
    if (error) std::rethrow_exception(error);
#else
    work.invoke(work.function);
#endif
}

/// On all threads, those of the team if there is one.
/// @return s, that the caller's thread has waited for the others: at the end, and at the beginning, where
/// OpenMP lets none start before all have come back from the loop before
double Executor::run_on_threads(int threads, const Team::Call& call) const {
    if (team_.threads() > 0) return team_.run(call);
    double waited = 0;
#if defined(_OPENMP)
    const double start = seconds_now();
    double done = start;
#pragma omp parallel num_threads(threads)
    {
        const int thread = omp_get_thread_num();
        const double begun = thread == 0 ? seconds_now() : 0;
        call.invoke(call.function, static_cast<std::size_t>(thread),
                    static_cast<std::size_t>(omp_get_num_threads()));
        if (thread == 0) waited = begun - start, done = seconds_now();
    }
    waited += seconds_now() - done;
#endif
    return waited;
}

void Executor::run(std::size_t chunks, Call call) const {
    if (parallel_for_ && !host_error_) {
        host_error_ = host_loop_->run(parallel_for_, chunks, {call.function, call.invoke});
        return;
    }
    if (parallel_for_ || threads_ < 2 || is_left_alone()) {
        for (std::size_t c = 0; c < chunks; ++c) call.invoke(call.function, c);
        return;
    }
    SharedTasks tasks(static_cast<std::size_t>(threads_), chunks);
    const auto share = [&](std::size_t thread, std::size_t) {
        tasks.work(thread, [&](std::size_t chunk) { call.invoke(call.function, chunk); });
    };
    const double start = seconds_now();
    const double waited = run_on_threads(threads_, team_call(share));
    note_wait(waited, seconds_now() - start - waited);
}

bool Executor::run_phases(std::span<const PhaseKind> phases, std::size_t tasks, PhaseCall call) const {
    if (threads_ < 2 || is_left_alone()) return false;
    const std::size_t most = std::min(static_cast<std::size_t>(threads_), tasks);
    phases_.begin(most, phases);
    const auto task = [call](std::size_t phase, std::size_t t) { call.invoke(call.function, phase, t); };
    const auto share = [&](std::size_t thread, std::size_t threads) {
        if (thread < most) phases_.work(thread, std::min(threads, most), tasks, task);
    };
    const double start = seconds_now();
    const double waited = run_on_threads(static_cast<int>(most), team_call(share)) + phases_.waited();
    note_wait(waited, seconds_now() - start - waited);
    return true;
}

}  // namespace carom

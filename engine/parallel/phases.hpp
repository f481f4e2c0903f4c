#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "parallel/waiting.hpp"

namespace carom {

/// How the tasks of a phase depend on the phase before.
enum class PhaseKind : std::uint8_t {
    side_by_side,  ///< task t on tasks t - 1, t and t + 1
    alone,         ///< the phase has one task, 0, which depends on all before it, as all after it does on it
};

/// How far threads are that work through phases of tasks. Each thread has a run of neighbouring tasks, the
/// same in every phase, and waits for the threads beside it alone; the tasks that these wait for come first.
/// So no thread waits because another one has a little more to do in one phase and less in the next.
class Phases {
  public:
    /// To be called before the threads start. Allocates if there have never been so many of them.
    void begin(std::size_t threads, std::span<const PhaseKind> kinds);

    /// Does the work of thread `thread` of `threads`: calls task(phase, t) for its tasks of every phase.
    /// @param tasks  >= threads, of each phase that is side by side
    template <class Task>
    void work(std::size_t thread, std::size_t threads, std::size_t tasks, const Task& task);

    /// s, that thread 0 has waited since `begin`, without waits so short that they do not matter.
    double waited() const { return waited_; }

  private:
    /// The number of phases in which a thread has done these, on a cache line of its own. They are counted
    /// from the first `begin` on, so that nothing has to be set back.
    struct alignas(64) Done {
        std::atomic<std::uint64_t> first{0}, last{0};  // of its tasks
        std::atomic<std::uint64_t> all{0};
        std::atomic<std::uint64_t> alone{0};  // thread 0 does what is done alone
    };
    using Count = std::atomic<std::uint64_t>;
    static bool has(const Count& count, std::uint64_t phases) {
        return count.load(std::memory_order_acquire) >= phases;
    }
    static void set(Count& count, std::uint64_t phases) { count.store(phases, std::memory_order_release); }

    /// A run of tasks of one thread in one phase.
    struct Run {
        std::size_t phase, first, last;  // last: of the run
        bool has_below, has_above;       // threads beside it
        const Done* own;
        std::uint64_t before;  // phases before this one
        // Nothing is before the first phase.
        bool may_begin() const { return !has_below || phase == 0 || has(own[-1].last, before); }
        bool may_end() const { return !has_above || phase == 0 || has(own[1].first, before); }
    };
    template <class Task>
    void work_through(const Run& run, std::size_t thread, const Task& task);
    template <class Ready>
    void wait(std::size_t thread, const Ready& is_ready) {
        const double waited = wait_until(is_ready);
        if (thread == 0) waited_ += waited;
    }

    std::unique_ptr<Done[]> done_;
    std::size_t room_ = 0;  // threads
    std::span<const PhaseKind> kinds_;
    std::uint64_t before_ = 0;  // phases of earlier calls
    double waited_ = 0;
};

template <class Task>
void Phases::work_through(const Run& run, std::size_t thread, const Task& task) {
    Done& own = done_[thread];
    const std::uint64_t after = run.before + 1;
    if (run.first == run.last) {
        wait(thread, [&] { return run.may_begin() && run.may_end(); });
        task(run.phase, run.first);
        set(own.first, after), set(own.last, after);
        return;
    }
    // Tasks that another thread waits for come first.
    bool is_begun = !run.has_below, is_ended = !run.has_above;
    std::size_t inner = is_begun ? run.first : run.first + 1;
    const std::size_t inner_end = is_ended ? run.last + 1 : run.last;
    while (true) {
        if (!is_begun && run.may_begin()) {
            task(run.phase, run.first);
            set(own.first, after), is_begun = true;
        } else if (!is_ended && run.may_end()) {
            task(run.phase, run.last);
            set(own.last, after), is_ended = true;
        } else if (inner < inner_end) {
            task(run.phase, inner++);
        } else if (!is_begun || !is_ended) {
            wait(thread, [&] { return (!is_begun && run.may_begin()) || (!is_ended && run.may_end()); });
        } else {
            return;
        }
    }
}

template <class Task>
void Phases::work(std::size_t thread, std::size_t threads, std::size_t tasks, const Task& task) {
    Done& own = done_[thread];
    Run run{.phase = 0,
            .first = thread * tasks / threads,
            .last = (thread + 1) * tasks / threads - 1,
            .has_below = thread > 0,
            .has_above = thread + 1 < threads,
            .own = &own,
            .before = before_};
    for (; run.phase < kinds_.size(); ++run.phase, ++run.before) {
        const std::uint64_t after = run.before + 1;
        if (kinds_[run.phase] == PhaseKind::side_by_side) {
            const bool follows_alone = run.phase > 0 && kinds_[run.phase - 1] == PhaseKind::alone;
            if (follows_alone) wait(thread, [&] { return has(done_[0].alone, run.before); });
            work_through(run, thread, task);
        } else {
            if (thread == 0) {
                for (std::size_t other = 1; other < threads && run.phase > 0; ++other)
                    wait(thread, [&] { return has(done_[other].all, run.before); });
                task(run.phase, 0);
                set(own.alone, after);
            }
            set(own.first, after), set(own.last, after);
        }
        set(own.all, after);
    }
}

}  // namespace carom

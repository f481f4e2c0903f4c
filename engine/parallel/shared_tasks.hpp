#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace carom {

/// Tasks that threads share: each thread has a run of neighbouring ones, the same whenever there are as many,
/// so that it finds in its cache what it has worked on before; when it is done it takes over what others have
/// not begun, from the ends of their runs. Which thread carries out a task must not matter.
class SharedTasks {
  public:
    /// @param tasks  < 2^32
    SharedTasks(std::size_t threads, std::size_t tasks) : count_(std::min(threads, kMostRuns)) {
        for (std::size_t run = 0; run < count_; ++run)
            runs_[run].left.store(packed(run * tasks / count_, (run + 1) * tasks / count_),
                                  std::memory_order_relaxed);
    }

    /// What thread `thread` does: calls task(number) until every one has been begun.
    template <class Task>
    void work(std::size_t thread, const Task& task) {
        std::size_t number;
        const std::size_t own = thread % count_;
        while (take(runs_[own], true, number)) task(number);
        for (std::size_t other = own + 1; other < own + count_; ++other)
            while (take(runs_[other % count_], false, number)) task(number);
    }

  private:
    /// The tasks of a thread that none has begun, on a cache line of its own: the first, and one beyond the
    /// last.
    struct alignas(64) Run {
        std::atomic<std::uint64_t> left{0};
    };
    static std::uint64_t packed(std::size_t first, std::size_t end) {
        return static_cast<std::uint64_t>(first) << 32 | static_cast<std::uint64_t>(end);
    }
    /// Takes the first or the last task of a run. @return false if there is none
    static bool take(Run& run, bool takes_first, std::size_t& number) {
        std::uint64_t left = run.left.load(std::memory_order_relaxed);
        while (true) {
            std::size_t first = left >> 32, end = left & UINT32_MAX;
            if (first == end) return false;
            number = takes_first ? first++ : --end;
            if (run.left.compare_exchange_weak(left, packed(first, end), std::memory_order_relaxed))
                return true;
        }
    }

    static constexpr std::size_t kMostRuns = 32;  // of more threads some share one
    std::array<Run, kMostRuns> runs_;
    std::size_t count_;
};

}  // namespace carom

#pragma once

#include <carom/world.hpp>

#include <algorithm>
#include <cstddef>

namespace carom {

inline constexpr std::size_t kRowsPerChunk = 2048;  // 8 KiB a float column
// From here on the cheapest loop of a step gains by a second thread: docs/decisions/0007-when-threads-pay.md.
inline constexpr std::size_t kSmallestParallelRows = 16384;
// ns: likewise, for loops that say how long they take.
inline constexpr double kShortestParallelLoop = 4000;

/// Runs chunks of rows, on several threads if there are any and the rows are many. Chunks depend on the rows
/// alone, never on the threads: work that writes by chunk gives the same result for any number of them.
class Executor {
  public:
    /// @param threads  0: as many as OpenMP gives; 1: the caller's alone.
    /// @param parallel_for  an embedding program's own threads in place of OpenMP
    explicit Executor(int threads = 1, ParallelFor parallel_for = {});

    int threads() const noexcept { return threads_; }

    /// Calls fn(chunk, first, last) for every chunk of [0, rows). fn must not throw; chunks must not write
    /// each other's rows. On one thread they run in order.
    template <class Fn>
    void for_each_chunk(std::size_t rows, std::size_t rows_per_chunk, const Fn& fn) const {
        const std::size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
        const auto chunk = [&](std::size_t c) {
            fn(c, c * rows_per_chunk, std::min(rows, (c + 1) * rows_per_chunk));
        };
        if (!is_parallel(rows) || chunks < 2) {
            for (std::size_t c = 0; c < chunks; ++c) chunk(c);
            return;
        }
        run(chunks, {&chunk, [](const void* call, std::size_t c) {
                         (*static_cast<const decltype(chunk)*>(call))(c);
                     }});
    }

    /// Calls fn(task) for every task below `tasks`, as for_each_chunk does for chunks.
    /// @param nanoseconds  about what all of them take on one thread: short loops stay on it
    template <class Fn>
    void for_each_task(std::size_t tasks, double nanoseconds, const Fn& fn) const {
        if (tasks < 2 || nanoseconds < kShortestParallelLoop || !has_threads()) {
            for (std::size_t task = 0; task < tasks; ++task) fn(task);
            return;
        }
        run(tasks, {&fn, [](const void* call, std::size_t task) { (*static_cast<const Fn*>(call))(task); }});
    }

    /// As for_each_chunk, for loops that are dearer than the cheapest.
    /// @param nanoseconds  about what a row takes on one thread
    template <class Fn>
    void for_each_chunk(std::size_t rows, std::size_t rows_per_chunk, double nanoseconds,
                        const Fn& fn) const {
        const std::size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
        for_each_task(chunks, nanoseconds * static_cast<double>(rows), [&](std::size_t c) {
            fn(c, c * rows_per_chunk, std::min(rows, (c + 1) * rows_per_chunk));
        });
    }

    /// Whether for_each_chunk would use more than the caller's thread.
    bool is_parallel(std::size_t rows) const noexcept {
        return rows >= kSmallestParallelRows && has_threads();
    }

  private:
    bool has_threads() const noexcept { return threads_ > 1 || (threads_ == 0 && parallel_for_); }
    struct Call {
        const void* function;
        void (*invoke)(const void*, std::size_t);
    };
    void run(std::size_t chunks, Call call) const;

    int threads_;  // 0: the embedding program knows
    ParallelFor parallel_for_;
    mutable int loops_alone_ = 0;       // that still run on one thread, because the machine is busy
    mutable int loops_next_time_ = 32;  // half of what the first wait that is too long costs
};

}  // namespace carom

#pragma once

#include <carom/world.hpp>

#include <algorithm>
#include <cstddef>
#include <exception>
#include <memory>
#include <span>

#include "parallel/host_loop.hpp"
#include "parallel/phases.hpp"
#include "parallel/team.hpp"
#include "parallel/team_trial.hpp"

namespace carom {

inline constexpr std::size_t kRowsPerChunk = 2048;  // 8 KiB a float column
// Rows from which on the cheapest loop of a step gains by a second thread
// (docs/decisions/0007-when-threads-pay.md).
inline constexpr std::size_t kSmallestParallelRows = 16384;
// ns from which on a loop that says how long it takes gains by a second thread.
inline constexpr double kShortestParallelLoop = 4000;

/// Runs chunks of rows, on several threads if there are any and the rows are many. Chunks depend on the rows
/// alone, never on the threads: work that writes by chunk gives the same result for any number of them.
class Executor {
  public:
    /// @param threads  0: as many as OpenMP gives; 1: the caller's alone.
    /// @param parallel_for  an embedding program's own threads in place of OpenMP. If it throws, the loop is
    /// finished on the caller's thread, and so are all others until rethrow_host_error.
    explicit Executor(int threads = 1, ParallelFor parallel_for = {});

    int threads() const noexcept { return threads_; }
    /// Throws what the embedding program's parallel-for has thrown since the last call, if it has.
    void rethrow_host_error() const;

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

    /// Does what the other for_each_chunk does, for loops that are dearer than the cheapest.
    /// @param nanoseconds  about what a row takes on one thread
    template <class Fn>
    void for_each_chunk(std::size_t rows, std::size_t rows_per_chunk, double nanoseconds,
                        const Fn& fn) const {
        const std::size_t chunks = (rows + rows_per_chunk - 1) / rows_per_chunk;
        for_each_task(chunks, nanoseconds * static_cast<double>(rows), [&](std::size_t c) {
            fn(c, c * rows_per_chunk, std::min(rows, (c + 1) * rows_per_chunk));
        });
    }

    /// Calls fn(phase, task) for every task of every phase. Tasks that depend on each other by the kinds of
    /// their phases run in the order of the phases; others must not write what one of them reads or writes.
    /// @param tasks  of each phase that is side by side
    /// @param nanoseconds  about what all of it takes on one thread: short work stays on it
    template <class Fn>
    void for_each_phase(std::span<const PhaseKind> phases, std::size_t tasks, double nanoseconds,
                        const Fn& fn) const {
        // (An embedding program's threads cannot wait for each other.)
        if (tasks > 1 && nanoseconds >= kShortestParallelLoop && has_threads() && !parallel_for_ &&
            run_phases(phases, tasks, {&fn, [](const void* call, std::size_t phase, std::size_t task) {
                                           (*static_cast<const Fn*>(call))(phase, task);
                                       }}))
            return;
        const double share = nanoseconds / static_cast<double>(phases.size());
        for (std::size_t phase = 0; phase < phases.size(); ++phase) {
            const std::size_t count = phases[phase] == PhaseKind::alone ? 1 : tasks;
            for_each_task(count, share, [&](std::size_t task) { fn(phase, task); });
        }
    }

    /// Calls work(), a step, whose loops then cost less: the other threads stand by for them all the while.
    /// Where steps do not gain by threads (team_trial.hpp), work() runs on the caller's thread alone.
    template <class Work>
    void with_team(const Work& work) const {
        if (threads_ < 2 || parallel_for_ || loops_alone_ > 0 || team_.threads() > 0 || is_alone_)
            return work();
        run_step({&work, [](const void* call) { (*static_cast<const Work*>(call))(); }});
    }

    /// Whether for_each_chunk would use more than the caller's thread.
    bool is_parallel(std::size_t rows) const noexcept {
        return rows >= kSmallestParallelRows && has_threads();
    }

  private:
    bool has_threads() const noexcept {
        return (threads_ > 1 && !is_alone_) || (threads_ == 0 && parallel_for_);
    }
    struct Call {
        const void* function;
        void (*invoke)(const void*, std::size_t);
    };
    void run(std::size_t chunks, Call call) const;
    struct PhaseCall {
        const void* function;
        void (*invoke)(const void*, std::size_t, std::size_t);
    };
    /// @return false if the machine is too busy for more than one thread: then nothing is done
    bool run_phases(std::span<const PhaseKind> phases, std::size_t tasks, PhaseCall call) const;
    struct TeamCall {
        const void* function;
        void (*invoke)(const void*);
    };
    void run_step(TeamCall work) const;
    void gather_team(TeamCall work) const;
    template <class Fn>
    static Team::Call team_call(const Fn& fn) {
        return {&fn, [](const void* call, std::size_t thread, std::size_t threads) {
                    (*static_cast<const Fn*>(call))(thread, threads);
                }};
    }
    double run_on_threads(int threads, const Team::Call& call) const;
    bool is_left_alone() const;
    void note_wait(double waited, double worked) const;

    int threads_;  // 0: the embedding program knows
    ParallelFor parallel_for_;
    std::unique_ptr<HostLoop> host_loop_;  // only with such threads
    mutable std::exception_ptr host_error_;
    mutable int loops_alone_ = 0;       // that still run on one thread, because the machine is busy
    mutable int loops_next_time_ = 32;  // half of what the first wait that is too long costs
    mutable Phases phases_;
    mutable Team team_;
    mutable TeamTrial trial_;
    mutable bool is_alone_ = false;  // in a step that does not use the threads
};

}  // namespace carom

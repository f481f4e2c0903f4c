#pragma once

#include <carom/world.hpp>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <memory>

namespace carom {

/// A loop on the threads of an embedding program, which may fail: each task is carried out exactly once
/// whatever they do, so that a step is never left half done.
class HostLoop {
  public:
    struct Task {
        const void* function;
        void (*invoke)(const void* function, std::size_t task);
    };

    /// Calls task 0 ... count - 1 by `parallel_for`, and those that it left out on this thread.
    /// Allocates if there have never been so many tasks.
    /// @return what `parallel_for` threw, if it did
    /// @throws what a task threw, after all of them have ended
    std::exception_ptr run(const ParallelFor& parallel_for, std::size_t count, Task task);

  private:
    enum Progress : std::uint8_t { kWaiting, kBegun, kDone };
    void carry_out(std::size_t task);

    std::unique_ptr<std::atomic<std::uint8_t>[]> progress_;
    std::size_t room_ = 0;  // tasks
    Task task_{};
    std::exception_ptr task_error_;  // the first
    std::atomic<bool> has_task_error_{false};
};

}  // namespace carom

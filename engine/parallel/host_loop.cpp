#include "parallel/host_loop.hpp"

#include <utility>

#include "parallel/waiting.hpp"

namespace carom {

void HostLoop::carry_out(std::size_t task) {
    std::uint8_t left = kWaiting;
    if (!progress_[task].compare_exchange_strong(left, kBegun)) return;
    try {
        task_.invoke(task_.function, task);
    } catch (...) {  // the host is not to see it: it may not be able to stand it
        if (!has_task_error_.exchange(true)) task_error_ = std::current_exception();
    }
    progress_[task].store(kDone, std::memory_order_release);
}

std::exception_ptr HostLoop::run(const ParallelFor& parallel_for, std::size_t count, Task task) {
    if (count > room_) progress_ = std::make_unique<std::atomic<std::uint8_t>[]>(count), room_ = count;
    for (std::size_t i = 0; i < count; ++i) progress_[i].store(kWaiting, std::memory_order_relaxed);
    task_ = task;
    std::exception_ptr error;
    try {
        parallel_for(count, [this](std::size_t i) { carry_out(i); });
    } catch (...) {
        error = std::current_exception();
    }
    for (std::size_t i = 0; i < count; ++i) carry_out(i);
    // What another thread has begun, it ends.
    for (std::size_t i = 0; i < count; ++i)
        wait_until([&] { return progress_[i].load(std::memory_order_acquire) == kDone; });
    if (has_task_error_.exchange(false)) std::rethrow_exception(std::exchange(task_error_, nullptr));
    return error;
}

}  // namespace carom

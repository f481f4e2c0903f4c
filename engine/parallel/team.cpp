#include "parallel/team.hpp"

#include "parallel/waiting.hpp"

namespace carom {

void Team::gather(std::size_t most) {
    if (most > room_) calls_ = std::make_unique<Count[]>(most), room_ = most;
    const std::uint64_t calls = announced().load(std::memory_order_relaxed);
    for (std::size_t thread = 1; thread < most; ++thread)
        calls_[thread].value.store(calls, std::memory_order_relaxed);
}

void Team::announce() {
    announced().store(announced().load(std::memory_order_relaxed) + 1, std::memory_order_release);
}

double Team::run(Call call) {
    call_ = call;
    announce();
    call.invoke(call.function, 0, threads_);
    const std::uint64_t calls = announced().load(std::memory_order_relaxed);
    double waited = 0;
    for (std::size_t thread = 1; thread < threads_; ++thread)
        waited += wait_until([&] { return calls_[thread].value.load(std::memory_order_acquire) == calls; });
    return waited;
}

void Team::dismiss() {
    call_ = {};
    announce();
    threads_ = 0;
}

void Team::stand_by(std::size_t thread) {
    std::uint64_t carried_out = calls_[thread].value.load(std::memory_order_relaxed);
    while (true) {
        wait_until([&] { return announced().load(std::memory_order_acquire) != carried_out; });
        ++carried_out;
        if (!call_.invoke) return;
        call_.invoke(call_.function, thread, threads_);
        calls_[thread].value.store(carried_out, std::memory_order_release);
    }
}

}  // namespace carom

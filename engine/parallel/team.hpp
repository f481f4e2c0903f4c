#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>

namespace carom {

/// Threads that stand by for loops while one of them, number 0, works through something serial: a loop then
/// costs one message to each and one back. docs/decisions/0012-threads-of-soft.md has the measurements.
class Team {
  public:
    struct Call {
        const void* function;
        void (*invoke)(const void* function, std::size_t thread, std::size_t threads);
    };

    /// Before the threads start; at most `most` will.
    void gather(std::size_t most);
    /// Thread 0: how many have started.
    void begin(std::size_t threads) { threads_ = threads; }
    std::size_t threads() const { return threads_; }
    /// Thread 0: all call `call`, each with its number; returns when all are done.
    /// @return s, that thread 0 has waited for the others
    double run(Call call);
    /// Thread 0: the others may go.
    void dismiss();
    /// The others: what they do until they are dismissed.
    void stand_by(std::size_t thread);

  private:
    /// On a cache line of its own.
    struct alignas(64) Count {
        std::atomic<std::uint64_t> value{0};
    };
    std::atomic<std::uint64_t>& announced() const { return calls_[0].value; }
    void announce();

    std::unique_ptr<Count[]>
        calls_;  // of thread 0: that it has announced; of another: that it has carried out
    std::size_t room_ = 0, threads_ = 0;
    Call call_{};  // null: the threads may go
};

}  // namespace carom

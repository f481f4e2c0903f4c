#pragma once

#include <array>
#include <chrono>
#include <cstdint>

#include "step/stage_info.hpp"

namespace carom {

/// Stopwatch over the stages: one reading of the clock a stage, about 25 ns each.
class StageTimes {
  public:
    void start() { last_ = Clock::now(); }

    /// The time since the last lap was spent in `stage`.
    void lap(StageName stage) {
        const Clock::time_point now = Clock::now();
        Entry& entry = entries_[static_cast<std::size_t>(stage)];
        entry.seconds += std::chrono::duration<double>(now - last_).count();
        ++entry.calls;
        last_ = now;
    }

    struct Entry {
        std::int64_t calls = 0;
        double seconds = 0;
    };
    const Entry& operator[](StageName stage) const { return entries_[static_cast<std::size_t>(stage)]; }

  private:
    using Clock = std::chrono::steady_clock;
    std::array<Entry, kStages.size()> entries_;
    Clock::time_point last_;
};

}  // namespace carom

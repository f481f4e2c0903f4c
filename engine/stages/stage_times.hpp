#pragma once

#include <array>
#include <cassert>
#include <chrono>
#include <cstdint>

namespace carom {

/// Stopwatch over the stages of a solver. A reading of the clock takes about 25 ns, which is much for a small
/// world: of steps that are shorter than kShortStep one in kStepsPerSample is timed, for all of them.
class StageTimes {
  public:
    static constexpr std::size_t kMostStages = 48;  // of a solver: soft_step.cpp asserts that it has fewer

    /// To be called when a step begins.
    void start() {
        if (steps_until_sample_ > 0) {
            --steps_until_sample_;
            is_timed_ = false;
            return;
        }
        is_timed_ = true;
        began_ = last_ = Clock::now();
    }

    /// Stage number `stage` begins: that is when the last lap ended.
    void begin(std::size_t) {}

    /// The time since the last lap was spent in stage number `stage`.
    void lap(std::size_t stage) {
        assert(stage < kMostStages);
        Entry& entry = entries_[stage];
        ++entry.calls;
        if (!is_timed_) return;
        const Clock::time_point now = Clock::now();
        entry.seconds += weight_ * std::chrono::duration<double>(now - last_).count();
        last_ = now;
    }

    /// To be called when a step ends.
    void finish() {
        if (!is_timed_) return;
        const bool is_short = last_ - began_ < kShortStep;
        steps_until_sample_ = is_short ? kStepsPerSample - 1 : 0;
        weight_ = is_short ? kStepsPerSample : 1;
    }

    struct Entry {
        std::int64_t calls = 0;
        double seconds = 0;
    };
    const Entry& operator[](std::size_t stage) const { return entries_[stage]; }

  private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::microseconds kShortStep{50};  // 20 laps are 1 % of it
    static constexpr int kStepsPerSample = 16;  // so that the stopwatch takes below 1 % of a short step

    std::array<Entry, kMostStages> entries_;
    Clock::time_point began_, last_;
    int steps_until_sample_ = 0;
    double weight_ = 1;  // steps that the next sample stands for
    bool is_timed_ = false;
};

}  // namespace carom

#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace carom::tool {

/// A line on a terminal that shows how far a run is, its steps a second and the time left. Writes nothing
/// when standard error is not a terminal. `unit`: what is counted, if it is not steps.
class ProgressBar {
  public:
    ProgressBar(std::int64_t step_count, bool wanted, const char* unit = "step");
    ~ProgressBar() { clear(); }
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

    /// Called after every step; draws a few times a second.
    void update(std::int64_t done);
    void clear();

  private:
    using Clock = std::chrono::steady_clock;

    std::int64_t step_count_;
    bool shown_;
    const char* unit_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_drawn_ = start_;
};

/// The line for one moment: bar, percentage, steps, steps a second, time left.
std::string progress_line(std::int64_t done, std::int64_t step_count, double seconds,
                          const char* unit = "step");

}  // namespace carom::tool

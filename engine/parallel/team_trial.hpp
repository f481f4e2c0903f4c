#pragma once

#include <algorithm>
#include <limits>

namespace carom {

/// Whether steps gain by threads: some steps are run on all of them and some on one, two of a kind after each
/// other, and the shorter way is taken until the next trial. The shortest step of each kind counts, since
/// what else a machine does makes steps longer, never shorter. docs/decisions/0007-when-threads-pay.md.
class TeamTrial {
  public:
    static constexpr int kSteps = 16;               // of a trial
    static constexpr double kLeastGain = 1.03;      // threads that gain less than this stand by for nothing
    static constexpr int kFewestStepsBetween = 64;  // trials; twice as many each time, up to
    static constexpr int kMostStepsBetween = 1024;  // these

    /// Whether the next step is to run on all threads.
    bool uses_threads() const { return is_in_trial() ? is_turn_of_threads() : pays_; }

    /// To be called after each step. @param seconds  that it took
    void note(double seconds) {
        if (is_in_trial()) {
            double& shortest = is_turn_of_threads() ? on_threads_ : on_one_;
            shortest = std::min(shortest, seconds);
        }
        ++number_;
        if (number_ == kSteps) pays_ = on_threads_ * kLeastGain < on_one_;
        if (number_ < kSteps + between_) return;
        number_ = 0, between_ = std::min(2 * between_, kMostStepsBetween);
        on_threads_ = on_one_ = std::numeric_limits<double>::infinity();
    }

  private:
    bool is_in_trial() const { return number_ < kSteps; }
    bool is_turn_of_threads() const { return number_ / 2 % 2 == 0; }

    int number_ = 0;  // of the step since the trial began
    int between_ = kFewestStepsBetween;
    double on_threads_ = std::numeric_limits<double>::infinity(), on_one_ = on_threads_;  // s, the shortest
    bool pays_ = true;
};

}  // namespace carom

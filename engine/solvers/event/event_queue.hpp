#pragma once

#include <array>
#include <cstddef>
#include <limits>

#include "state/columns/column.hpp"

namespace carom {

/// The earliest of many times, each of which changes often: a tournament in groups of eight, so that every
/// match is one cache line. Among equal times the lowest number wins.
///
/// Cost: a changed time is compared with the seven beside it, and further up only where the winner changes:
/// mostly one line. `first` looks at one line a level, log8(count) of them.
class EventQueue {
  public:
    /// `count` times, all of them never.
    void reset(std::size_t count) {
        constexpr double kLate = std::numeric_limits<double>::infinity();
        depth_ = 0;
        do {
            count = (count + kGroup - 1) / kGroup;
            Column<double>& level = levels_[depth_++];
            level.resize_for_overwrite(count * kGroup);
            for (double& time : level) time = kLate;
        } while (count > 1);
    }

    void set(std::size_t number, double time) {
        for (std::size_t level = 0;; ++level) {
            double* times = levels_[level].data();
            times[number] = time;
            if (level + 1 == depth_) return;
            number /= kGroup;
            time = earliest(times + number * kGroup);
            if (levels_[level + 1][number] == time) return;
        }
    }

    double first_time() const { return earliest(levels_[depth_ - 1].data()); }

    std::size_t first() const {
        std::size_t number = 0;
        for (std::size_t level = depth_; level-- > 0;) {
            const double* times = levels_[level].data() + number * kGroup;
            const double time = earliest(times);
            std::size_t winner = 0;
            while (times[winner] != time) ++winner;
            number = number * kGroup + winner;
        }
        return number;
    }

    template <class Self, class Archive>
    static void visit_state(Self& self, Archive& archive) {
        archive(self.levels_, self.depth_);
    }

    std::size_t bytes() const {
        std::size_t sum = 0;
        for (const Column<double>& level : levels_) sum += level.bytes();
        return sum;
    }

  private:
    static constexpr std::size_t kGroup = 8;        // doubles of a cache line
    static constexpr std::size_t kMostLevels = 11;  // 8^11 = 2^33 times

    static double earliest(const double* times) {
        const auto least = [](double a, double b) { return a < b ? a : b; };
        return least(least(least(times[0], times[1]), least(times[2], times[3])),
                     least(least(times[4], times[5]), least(times[6], times[7])));
    }

    std::array<Column<double>, kMostLevels> levels_;  // the first has all times, each next one the winners
    std::size_t depth_ = 0;
};

}  // namespace carom

#pragma once

#include <carom/world.hpp>

#include <array>
#include <cstddef>
#include <functional>
#include <vector>

namespace carom::tool {

/// Measures which part of a world's steps threads could share: it carries out its loops itself, on the thread
/// that calls, in place of threads of an embedding program, and takes the time of every task. So the figures
/// hold on a machine of one core, too, and no other program's use of a second core is in them.
class SharedLoops {
  public:
    /// Numbers of cores that `on_cores` is found for.
    static constexpr std::array<std::size_t, 3> kCores{4, 16, 64};

    /// @return what WorldOptions::parallel_for is to be; it refers to this object
    ParallelFor parallel_for();

    /// Times of all loops until now, together [s].
    struct Seconds {
        double inside = 0;  ///< from the start of each loop to its end, with what measuring took
        double tasks = 0;   ///< of the tasks alone
        /// The loops last so long on each of kCores: each thread takes as many neighbouring tasks, and a loop
        /// ends with the thread that has most to do. Starting threads costs nothing in it.
        std::array<double, kCores.size()> on_cores{};

        Seconds operator-(const Seconds& other) const;
    };
    const Seconds& seconds() const { return seconds_; }

  private:
    void run(std::size_t count, const std::function<void(std::size_t)>& task);

    Seconds seconds_;
    std::vector<double> ends_;  // s, of the present loop: when task i - 1 ended; at 0 when the loop began
};

}  // namespace carom::tool

#include "measure/clocks.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>

namespace carom::measure {

double thread_seconds() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double wall_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double seconds_of_a_clock_reading() {
    constexpr int kAttempts = 10, kReadings = 5'000;
    double unused = 0, least = 1;
    for (int attempt = 0; attempt < kAttempts;
         ++attempt) {  // the least: interruptions are no part of a reading
        const double start = thread_seconds();
        for (int i = 0; i < kReadings; ++i) unused += wall_seconds();
        least = std::min(least, (thread_seconds() - start) / kReadings);
    }
    return unused > 0 ? least : 0;
}

}  // namespace carom::measure

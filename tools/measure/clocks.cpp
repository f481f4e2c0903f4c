#include "measure/clocks.hpp"

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
    constexpr int kReadings = 100'000;
    double unused = 0;
    const double start = thread_seconds();
    for (int i = 0; i < kReadings; ++i) unused += wall_seconds();
    const double seconds = thread_seconds() - start;
    return unused > 0 ? seconds / kReadings : 0;
}

}  // namespace carom::measure

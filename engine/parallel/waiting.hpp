#pragma once

#include <chrono>
#include <thread>

namespace carom {

inline double seconds_now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Waits for what another thread does at this moment: looks again and again, and after some 50 µs lets other
/// programs run between looks.
/// @return s, if it took that long, else 0
template <class Ready>
double wait_until(const Ready& is_ready) {
    constexpr int kShortWait = 2048;  // looks
    for (int i = 0; i < kShortWait; ++i) {
        if (is_ready()) return 0;
#if defined(__x86_64__)
        __builtin_ia32_pause();
#endif
    }
    const double start = seconds_now();
    while (!is_ready()) std::this_thread::yield();
    return seconds_now() - start;
}

}  // namespace carom

#include "format.hpp"

#include <algorithm>
#include <array>
#include <cstdarg>
#include <cstdio>

namespace carom::tool {

std::string format(const char* pattern, ...) {
    std::array<char, 256> fixed;
    std::va_list arguments, again;
    va_start(arguments, pattern);
    va_copy(again, arguments);
    const int length = std::vsnprintf(fixed.data(), fixed.size(), pattern, arguments);
    va_end(arguments);
    std::string text(fixed.data(), std::min<std::size_t>(fixed.size() - 1, static_cast<std::size_t>(length)));
    if (static_cast<std::size_t>(length) >= fixed.size()) {
        text.resize(static_cast<std::size_t>(length));
        std::vsnprintf(text.data(), text.size() + 1, pattern, again);
    }
    va_end(again);
    return text;
}

double without_minus_zero(double value, int decimals) {
    double smallest = 0.5;
    for (int i = 0; i < decimals; ++i) smallest /= 10;
    return value <= 0 && value > -smallest ? 0.0 : value;
}

std::string bytes_text(double bytes) {
    constexpr std::array<const char*, 4> kUnits{"B", "KiB", "MiB", "GiB"};
    std::size_t unit = 0;
    while (bytes >= 1024 && unit + 1 < kUnits.size()) bytes /= 1024, ++unit;
    return format(unit == 0 ? "%.0f %s" : "%.1f %s", bytes, kUnits[unit]);
}

std::string seconds_text(double seconds) {
    if (seconds < 1e-6) return format("%.0f ns", seconds * 1e9);
    if (seconds < 1e-3) return format("%.3g us", seconds * 1e6);
    if (seconds < 1) return format("%.3g ms", seconds * 1e3);
    return format("%.3g s", seconds);
}

}  // namespace carom::tool

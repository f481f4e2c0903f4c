#include "measure/text.hpp"

#include <cstdarg>
#include <cstdio>

namespace carom::measure {

std::string format(const char* pattern, ...) {
    va_list values, again;
    va_start(values, pattern);
    va_copy(again, values);
    const int length = std::vsnprintf(nullptr, 0, pattern, values);
    va_end(values);
    std::string text(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
    std::vsnprintf(text.data(), text.size() + 1, pattern, again);
    va_end(again);
    return text;
}

std::string grouped(long long value) {
    std::string text = std::to_string(value);
    const std::size_t digits_from = value < 0 ? 1 : 0;
    for (std::size_t place = text.size(); place > digits_from + 3;) text.insert(place -= 3, 1, ',');
    return text;
}

}  // namespace carom::measure

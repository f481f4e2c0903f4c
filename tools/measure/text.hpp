#pragma once

#include <string>
#include <string_view>

namespace carom::measure {

/// Texts one after the other.
template <class... Parts>
std::string joined(const Parts&... parts) {
    std::string text;
    (text.append(std::string_view(parts)), ...);
    return text;
}

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

/// The value of a whole number with its digits in groups: "1,000,000".
std::string grouped(long long value);

}  // namespace carom::measure

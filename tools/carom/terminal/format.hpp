#pragma once

#include <string>
#include <string_view>

namespace carom::tool {

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

/// Texts one after the other.
template <class... Parts>
std::string joined(const Parts&... parts) {
    std::string text;
    (text.append(std::string_view(parts)), ...);
    return text;
}

/// The value, but 0 where it would be printed as "-0.00" with so many decimals.
double without_minus_zero(double value, int decimals);

std::string bytes_text(double bytes);      ///< "1.2 MiB"
std::string seconds_text(double seconds);  ///< "3.21 ms"

}  // namespace carom::tool

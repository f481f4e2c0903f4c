#pragma once

#include <string>

namespace carom::tool {

/// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

/// The value, but 0 where it would be printed as "-0.00" with so many decimals.
double without_minus_zero(double value, int decimals);

std::string bytes_text(double bytes);      ///< "1.2 MiB"
std::string seconds_text(double seconds);  ///< "3.21 ms"

}  // namespace carom::tool

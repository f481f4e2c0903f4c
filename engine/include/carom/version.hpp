#pragma once

#include <string_view>

namespace carom {

/// The version of the library, `major.minor.patch`; the program prints it with `carom --version`.
inline constexpr std::string_view kVersion = "0.1.0";

/// The version of the library that was linked: differs from kVersion when headers and library do not belong
/// together.
std::string_view version() noexcept;

}  // namespace carom

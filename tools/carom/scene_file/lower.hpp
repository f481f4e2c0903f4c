#pragma once

namespace carom::tool {

/// The small letter of a large one of ASCII, whatever the locale; other characters as they are.
constexpr char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

}  // namespace carom::tool

#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace carom::report {

/// Appends the bytes in base64 (RFC 4648, section 4), padded.
void append_base64(std::string& text, std::span<const std::byte> bytes);

/// The bytes of an array, low byte first, as pages read them.
template <class Value>
std::string base64_of(std::span<const Value> values) {
    std::string text;
    append_base64(text, std::as_bytes(values));
    return text;
}

}  // namespace carom::report

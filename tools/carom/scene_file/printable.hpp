#pragma once

#include <string>
#include <string_view>

namespace carom::tool {

/// The text with control characters, and bytes that are not UTF-8, made visible as \xNN: messages quote files
/// that may be hostile, and go to terminals.
std::string printable(std::string_view text);

/// At most `bytes` of it, whole characters, with "..." where it was cut.
std::string shortened(std::string_view text, std::size_t bytes);

/// A token of a JSON pointer: escaped as the standard (RFC 6901) says, and cut when very long.
std::string pointer_token(std::string_view key);

}  // namespace carom::tool

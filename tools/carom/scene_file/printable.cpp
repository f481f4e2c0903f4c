#include "scene_file/printable.hpp"

#include <algorithm>
#include <cstddef>

namespace carom::tool {
namespace {

constexpr std::size_t kLongestToken = 64;  // bytes

bool continues(char c) {
    return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

/// Length of the UTF-8 sequence that a first byte announces; 0 if it cannot be one.
std::size_t announced_length(unsigned char first) {
    if (first < 0x80) return 1;
    if (first >= 0xc2 && first < 0xe0) return 2;
    if (first >= 0xe0 && first < 0xf0) return 3;
    return first >= 0xf0 && first < 0xf5 ? 4 : 0;
}

/// Length of the printable character at the start; 0 if there is none.
std::size_t printable_length(std::string_view text) {
    const auto first = static_cast<unsigned char>(text[0]);
    const std::size_t length = announced_length(first);
    if (length == 0 || length > text.size()) return 0;
    if (length == 1) return first >= 0x20 && first != 0x7f ? 1 : 0;
    if (!std::all_of(text.begin() + 1, text.begin() + static_cast<std::ptrdiff_t>(length), continues))
        return 0;
    const bool control = first == 0xc2 && static_cast<unsigned char>(text[1]) < 0xa0;
    return control ? 0 : length;
}

}  // namespace

std::string printable(std::string_view text) {
    constexpr std::string_view kHex = "0123456789abcdef";
    std::string out;
    out.reserve(text.size());
    while (!text.empty()) {
        const std::size_t length = printable_length(text);
        if (length == 0) {
            const auto byte = static_cast<unsigned char>(text[0]);
            out.append({'\\', 'x', kHex[byte >> 4], kHex[byte & 15]});
        } else {
            out.append(text.substr(0, length));
        }
        text.remove_prefix(std::max<std::size_t>(length, 1));
    }
    return out;
}

std::string shortened(std::string_view text, std::size_t bytes) {
    if (text.size() <= bytes) return std::string(text);
    while (bytes > 0 && continues(text[bytes])) --bytes;
    return std::string(text.substr(0, bytes)).append("...");
}

std::string pointer_token(std::string_view key) {
    std::string out;
    for (const char c : shortened(key, kLongestToken)) {
        if (c == '~') {
            out.append("~0");
        } else if (c == '/') {
            out.append("~1");
        } else {
            out.push_back(c);
        }
    }
    return out;
}

}  // namespace carom::tool

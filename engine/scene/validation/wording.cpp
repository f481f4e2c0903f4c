#include "scene/validation/wording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace carom {
namespace {

constexpr std::size_t kLongestQuote = 64;  // bytes; names are for people, files may be hostile

}  // namespace

std::string to_text(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

void append(std::string& text, std::string_view part) {
    text.append(part);
}

void append(std::string& text, double part) {
    text.append(to_text(part));
}

void append(std::string& text, Vec2 part) {
    text.append("[").append(to_text(part.x)).append(", ").append(to_text(part.y)).append("]");
}

std::string quoted(std::string_view text) {
    constexpr std::string_view kHex = "0123456789abcdef";
    std::size_t length = std::min(text.size(), kLongestQuote);
    while (length < text.size() && length > 0 && (text[length] & 0xc0) == 0x80) --length;  // whole characters
    std::string out = "\"";
    char before = 0;
    for (const char c : text.substr(0, length)) {
        const auto byte = static_cast<unsigned char>(c);
        const bool control = byte < 0x20 || byte == 0x7f || (before == '\xc2' && byte >= 0x80 && byte < 0xa0);
        before = c;
        if (c == '"' || c == '\\') {
            out.append({'\\', c});
        } else if (control) {
            out.append({'\\', 'x', kHex[byte >> 4], kHex[byte & 15]});
        } else {
            out.push_back(c);
        }
    }
    if (length < text.size()) out.append("...");
    return out.append("\"");
}

std::string Item::subject() const {
    std::string text(words);
    if (index < 0) return text;
    text.append(" ").append(std::to_string(index));
    if (!name.empty()) text.append(" (").append(quoted(name)).append(")");
    return text.append(" has");
}

std::string Item::path() const {
    std::string text(pointer);
    if (index >= 0) text.append("/").append(std::to_string(index));
    return text;
}

namespace {

Problem outside(const Item& item, std::string_view tail, double value, const Quantity& quantity) {
    const std::string_view space = quantity.unit.empty() ? "" : " ";
    return problem(std::isfinite(value) ? ErrorCode::out_of_range : ErrorCode::not_finite, item, tail,
                   quantity.name, " ", value, space, quantity.unit, "; expected ", quantity.low,
                   " <= ", quantity.name, " <= ", quantity.high, space, quantity.unit, ". ", quantity.remedy);
}

}  // namespace

std::optional<Problem> check(const Item& item, std::string_view tail, double value,
                             const Quantity& quantity) {
    if (value >= quantity.low && value <= quantity.high) return std::nullopt;  // NaN fails too
    return outside(item, tail, value, quantity);
}

void raise(std::string_view where, const Problem& found) {
    throw Error(found.code, join(where, ": ", found.statement));
}

}  // namespace carom

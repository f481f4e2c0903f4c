#include "scene/wording.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

namespace carom {
namespace {

constexpr std::size_t kLongestQuote = 64;  // bytes; names are for people, files may be hostile

std::string with_unit(double value, std::string_view unit) {
    std::string text = to_text(value);
    if (!unit.empty()) text.append(" ").append(unit);
    return text;
}

}  // namespace

std::string to_text(double value) {
    std::array<char, 32> digits{};
    const auto end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
    return {digits.data(), end};
}

std::string to_text(Vec2 value) {
    return "[" + to_text(value.x) + ", " + to_text(value.y) + "]";
}

std::string quoted(std::string_view text) {
    constexpr std::string_view kHex = "0123456789abcdef";
    std::size_t length = std::min(text.size(), kLongestQuote);
    while (length < text.size() && length > 0 && (text[length] & 0xc0) == 0x80) --length;  // whole characters
    std::string out = "\"";
    for (const char c : text.substr(0, length)) {
        const auto byte = static_cast<unsigned char>(c);
        if (c == '"' || c == '\\') {
            out.append({'\\', c});
        } else if (byte < 0x20 || byte == 0x7f) {
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

Problem problem(ErrorCode code, const Item& item, std::string_view tail, std::string_view words) {
    return {code, item.path().append(tail), item.subject().append(" ").append(words)};
}

namespace {
Problem outside(const Item& item, std::string_view tail, double value, const Quantity& quantity) {
    std::string words(quantity.name);
    words.append(" ").append(with_unit(value, quantity.unit)).append("; expected ");
    words.append(to_text(quantity.low)).append(" <= ").append(quantity.name).append(" <= ");
    words.append(with_unit(quantity.high, quantity.unit)).append(". ").append(quantity.remedy);
    return problem(std::isfinite(value) ? ErrorCode::out_of_range : ErrorCode::not_finite, item, tail, words);
}
}  // namespace

std::optional<Problem> check(const Item& item, std::string_view tail, double value,
                             const Quantity& quantity) {
    if (value >= quantity.low && value <= quantity.high) return std::nullopt;  // NaN fails too
    return outside(item, tail, value, quantity);
}

void raise(std::string_view where, const Problem& found) {
    throw Error(found.code, std::string(where).append(": ").append(found.statement));
}

}  // namespace carom

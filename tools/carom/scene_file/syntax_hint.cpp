#include "scene_file/syntax_hint.hpp"

#include <algorithm>
#include <array>

#include "scene_file/lower.hpp"
#include "scene_file/printable.hpp"

namespace carom::tool {
namespace {

constexpr int kNumberOverflow = 406;        // the parser's number of that error
constexpr std::size_t kLongestWords = 160;  // bytes quoted from the parser

bool is_space(char c) {
    return c == ' ' || c == '\t' || c == '\n' || c == '\r';
}

bool starts_with_word(std::string_view text, std::string_view word) {
    return text.size() >= word.size() &&
           std::equal(word.begin(), word.end(), text.begin(), [](char a, char b) { return a == lower(b); });
}

bool comes_after_comma(std::string_view before) {
    while (!before.empty() && is_space(before.back())) before.remove_suffix(1);
    return !before.empty() && before.back() == ',';
}

struct WordHint {
    std::string_view word;
    std::string_view hint;
};

constexpr std::string_view kTooShort = "the text ends too early; the file may be cut off";
constexpr std::string_view kNoComments = "comments are not JSON; take them out";
constexpr std::string_view kNoNan = "JSON has no NaN and no infinity; give a finite number";
constexpr std::array kWordHints{
    WordHint{"//", kNoComments},
    WordHint{"/*", kNoComments},
    WordHint{"#", kNoComments},
    WordHint{"nan", kNoNan},
    WordHint{"inf", kNoNan},
    WordHint{"-nan", kNoNan},
    WordHint{"-inf", kNoNan},
    WordHint{"+nan", kNoNan},
    WordHint{"+inf", kNoNan},
    WordHint{"+", "numbers have no plus sign in JSON; leave it out"},
    WordHint{".", "numbers start with a digit in JSON; write 0.5, not .5"},
    WordHint{"-.", "numbers start with a digit in JSON; write -0.5, not -.5"},
    WordHint{"'", "strings are in double quotes in JSON"},
    WordHint{"none", "write null in place of None"},
    WordHint{"true", "write true in small letters"},
    WordHint{"false", "write false in small letters"},
    WordHint{"null", "write null in small letters"},
};

bool is_of_word(char c) {
    constexpr std::string_view kSigns = "+-./*#'";
    return (lower(c) >= 'a' && lower(c) <= 'z') || kSigns.find(c) != std::string_view::npos;
}

/// Where the word begins whose last byte read is the one before `read`.
std::size_t word_begin(std::string_view text, std::size_t read) {
    std::size_t begin = read == 0 ? 0 : read - 1;
    while (begin > 0 && is_of_word(text[begin]) && is_of_word(text[begin - 1])) --begin;
    return begin;
}

/// Empty if the mistake is none of the common ones.
std::string_view hint_for(std::string_view text, std::size_t start) {
    const std::string_view rest = text.substr(start);
    if (rest.empty()) return {};
    for (const WordHint& known : kWordHints)
        if (starts_with_word(rest, known.word)) return known.hint;
    if ((rest[0] == '}' || rest[0] == ']') && comes_after_comma(text.substr(0, start)))
        return "the comma before it is one too many; take it out";
    return {};
}

/// The parser's words without its name and the position, which are said already.
std::string_view without_preamble(std::string_view complaint) {
    const std::size_t column = complaint.find("column ");
    if (column == std::string_view::npos) return complaint;
    const std::size_t colon = complaint.find(": ", column);
    return colon == std::string_view::npos ? complaint : complaint.substr(colon + 2);
}

std::string place_words(std::string_view text, std::size_t start) {
    const std::string_view before = text.substr(0, start);
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const std::size_t line_begin = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    return "line " + std::to_string(line) + ", column " + std::to_string(start - line_begin + 1);
}

}  // namespace

SyntaxHint explain_syntax_error(std::string_view text, std::size_t position, std::string_view token,
                                std::string_view complaint, int id) {
    const std::size_t read =
        std::min(position, text.size());  // one more than there are at the end of the text
    std::string words = place_words(text, read == 0 ? 0 : read - 1);
    if (id == kNumberOverflow) {
        words.append(": the number ").append(shortened(token, kLongestWords));
        words.append(" is too large for double precision; expected a finite number.");
        return {ErrorCode::not_finite, words};
    }
    words.append(": this is not JSON: ");
    const std::string_view hint = position > text.size() ? kTooShort : hint_for(text, word_begin(text, read));
    if (!hint.empty()) {
        words.append(hint).append(".");
    } else {
        words.append(shortened(without_preamble(complaint), kLongestWords)).append(".");
    }
    return {ErrorCode::malformed, words};
}

}  // namespace carom::tool

#include "option_values.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <system_error>

#include "exit_codes.hpp"
#include "format.hpp"
#include "scene_file/nearest_name.hpp"
#include "scene_file/printable.hpp"

namespace carom::tool {
namespace {

constexpr std::size_t kLongestQuote = 60;  // bytes of a wrong value that are worth repeating

[[noreturn]] void refuse(std::string_view option, const std::string& text, std::string_view expected) {
    throw UsageError(
        joined(option, ": \"", printable(shortened(text, kLongestQuote)), "\" is not ", expected));
}

/// Whether all of the text is one number of that type.
template <class Number>
bool read_all(const std::string& text, Number& value) {
    const char* const end = text.data() + text.size();
    const std::from_chars_result result = std::from_chars(text.data(), end, value);
    return result.ec == std::errc() && result.ptr == end;
}

}  // namespace

std::int64_t whole_number(std::string_view option, const std::string& text, std::int64_t min,
                          std::int64_t max) {
    std::int64_t value = 0;
    if (!read_all(text, value) || value < min || value > max)
        refuse(option, text,
               joined("a whole number from ", std::to_string(min), " to ", std::to_string(max)));
    return value;
}

double real_number(std::string_view option, const std::string& text) {
    double value = 0;
    if (!read_all(text, value)) refuse(option, text, "a number such as 0.016 or 1e-3");
    return value;
}

const std::string& known_value(std::string_view option, const std::string& text,
                               const std::vector<std::string_view>& known) {
    if (std::find(known.begin(), known.end(), text) == known.end())
        refuse(option, text, joined("one of its values; ", known_names(text, known)));
    return text;
}

std::vector<std::string> split_at_commas(const std::string& text) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t comma; (comma = text.find(',', begin)) != std::string::npos; begin = comma + 1)
        parts.push_back(text.substr(begin, comma - begin));
    parts.push_back(text.substr(begin));
    return parts;
}

void add_page_size_option(CLI::App& command, std::size_t& bytes) {
    constexpr std::int64_t kMegabyte = 1'000'000, kMost = 2000;  // browsers refuse larger files
    command
        .add_option_function<std::string>(
            "--page-size",
            [&bytes](const std::string& text) {
                bytes = static_cast<std::size_t>(kMegabyte * whole_number("--page-size", text, 1, kMost));
            },
            "Megabytes the page may have; frames are thinned until it fits (default: 50)")
        ->type_name("MB");
}

}  // namespace carom::tool

#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}

namespace carom::tool {

/// The value of an option as a whole number from `min` to `max`. @throws UsageError
std::int64_t whole_number(std::string_view option, const std::string& text, std::int64_t min,
                          std::int64_t max);

/// The value of an option as a number; that it is finite and sensible the scene checks. @throws UsageError
double real_number(std::string_view option, const std::string& text);

/// One of `known`, spelt as there. @throws UsageError naming the nearest one
const std::string& known_value(std::string_view option, const std::string& text,
                               const std::vector<std::string_view>& known);

/// The parts between commas, empty ones included.
std::vector<std::string> split_at_commas(const std::string& text);

/// Adds --page-size: megabytes a page may have.
void add_page_size_option(CLI::App& command, std::size_t& bytes);

}  // namespace carom::tool

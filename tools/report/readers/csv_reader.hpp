#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace carom::report {

using CsvRow = std::vector<std::string>;

/// Hands over the rows of a CSV file (RFC 4180) one by one, the headings first, until `take` returns false.
/// @throws ResultError if the file cannot be read.
void read_csv(const std::filesystem::path& path, const std::function<bool(const CsvRow&)>& take);

/// Columns of numbers by name.
struct NumberTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;
    std::size_t rows_in_file = 0;

    std::size_t row_count() const { return columns.empty() ? 0 : columns[0].size(); }
    /// Empty if there is no such column.
    const std::vector<double>& at(std::string_view name) const;
};

/// All rows of a CSV file of numbers; if there are more than `most_rows`, every n-th of them and the last.
/// @throws ResultError
NumberTable read_numbers(const std::filesystem::path& path, std::size_t most_rows);

}  // namespace carom::report

#include "report/readers/csv_reader.hpp"

#include <charconv>
#include <fstream>
#include <limits>

#include "report/readers/result_error.hpp"

namespace carom::report {
namespace {

/// Adds the fields of a line to the row. Whether the row goes on in the next line: a quoted field has not
/// ended.
class RowReader {
  public:
    bool add_line(std::string_view line, CsvRow& row) {
        if (quoted_) field_ += '\n';
        for (std::size_t i = 0; i < line.size(); ++i) {
            const char c = line[i];
            if (quoted_) {
                if (c != '"')
                    field_ += c;
                else if (i + 1 < line.size() && line[i + 1] == '"')
                    field_ += line[++i];
                else
                    quoted_ = false;
            } else if (c == '"') {
                quoted_ = true;
            } else if (c == ',') {
                finish(row);
            } else {
                field_ += c;
            }
        }
        if (!quoted_) finish(row);
        return quoted_;
    }

  private:
    void finish(CsvRow& row) {
        row.push_back(std::move(field_));
        field_.clear();
    }

    std::string field_;
    bool quoted_ = false;
};

double number(const std::string& text) {
    double value = std::numeric_limits<double>::quiet_NaN();
    std::from_chars(text.data(), text.data() + text.size(), value);
    return value;
}

void keep_every_second(std::vector<std::vector<double>>& columns) {
    for (std::vector<double>& column : columns) {
        std::size_t kept = 0;
        for (std::size_t row = 0; row < column.size(); row += 2) column[kept++] = column[row];
        column.resize(kept);
    }
}

void append(std::vector<std::vector<double>>& columns, const std::vector<double>& row) {
    for (std::size_t i = 0; i < columns.size(); ++i)
        columns[i].push_back(i < row.size() ? row[i] : std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

void read_csv(const std::filesystem::path& path, const std::function<bool(const CsvRow&)>& take) {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw ResultError(path.string() + ": cannot be read");
    RowReader reader;
    std::string line;
    CsvRow row;
    while (std::getline(file, line)) {
        if (reader.add_line(line, row)) continue;
        if (!take(row)) return;
        row.clear();
    }
}

const std::vector<double>& NumberTable::at(std::string_view name) const {
    static const std::vector<double> none;
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return columns[i];
    return none;
}

NumberTable read_numbers(const std::filesystem::path& path, std::size_t most_rows) {
    NumberTable table;
    std::vector<double> last;
    std::size_t stride = 1;
    bool last_is_kept = true;
    read_csv(path, [&](const CsvRow& row) {
        if (table.names.empty()) {
            table.names = row;
            table.columns.resize(row.size());
            return true;
        }
        last.clear();
        for (const std::string& field : row) last.push_back(number(field));
        last_is_kept = table.rows_in_file++ % stride == 0;
        if (last_is_kept) append(table.columns, last);
        if (table.row_count() > most_rows) {
            last_is_kept = table.row_count() % 2 == 1;  // the first and every second one stay
            keep_every_second(table.columns);
            stride *= 2;
        }
        return true;
    });
    if (!last_is_kept) append(table.columns, last);
    return table;
}

}  // namespace carom::report

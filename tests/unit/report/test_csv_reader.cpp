#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "report/readers/csv_reader.hpp"

namespace test_csv_reader {

using namespace carom::report;

namespace {

struct TextFile {
    std::filesystem::path path = std::filesystem::temp_directory_path() / "carom-test-table.csv";
    explicit TextFile(const std::string& text) { std::ofstream(path, std::ios::binary) << text; }
    ~TextFile() { std::filesystem::remove(path); }
};

}  // namespace

TEST_SUITE("report/csv_reader") {
    TEST_CASE("quoted fields hold commas, quotes and line ends") {
        const TextFile file("id,name\n0,\"a, \"\"b\"\"\nc\"\n1,\n");
        std::vector<CsvRow> rows;
        read_csv(file.path, [&](const CsvRow& row) {
            rows.push_back(row);
            return true;
        });
        CHECK(rows == std::vector<CsvRow>{{"id", "name"}, {"0", "a, \"b\"\nc"}, {"1", ""}});
    }

    TEST_CASE("a long table is thinned to every n-th row, and its first and last are kept as they are") {
        for (const int count : {1, 2, 99, 100, 101, 200, 201, 1000, 1023, 1024, 1025}) {
            CAPTURE(count);
            std::string text = "time,energy\n";
            for (int i = 0; i < count; ++i) text += std::to_string(i) + "," + std::to_string(i) + ".5\n";
            const TextFile file(text);
            const NumberTable table = read_numbers(file.path, 100);
            const std::vector<double>&time = table.at("time"), &energy = table.at("energy");
            CHECK(table.rows_in_file == static_cast<std::size_t>(count));
            CHECK(time.size() <= 101);
            CHECK(time.size() >= static_cast<std::size_t>(std::min(count, 50)));
            CHECK(time.front() == 0);
            CHECK(time.back() == count - 1);
            for (std::size_t i = 0; i < time.size(); ++i) CHECK(energy[i] == time[i] + 0.5);
            for (std::size_t i = 2; i + 1 < time.size(); ++i)
                CHECK(time[i] - time[i - 1] == time[1] - time[0]);
        }
    }
}

}  // namespace test_csv_reader

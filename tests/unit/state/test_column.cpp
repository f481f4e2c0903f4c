#include "state/columns/column.hpp"

#include <doctest/doctest.h>
#include <cstdint>

namespace test_column {

using carom::Column;

TEST_SUITE("state/column") {
    TEST_CASE("rows are aligned to a cache line and the padding is zero, however the column was resized") {
        Column<float> column;
        for (const std::size_t rows : {1u, 40u, 17u, 0u, 16u, 1000u, 3u}) {
            CAPTURE(rows);
            column.resize(rows);
            for (float& value : column) value = 1.0f;
            CHECK(reinterpret_cast<std::uintptr_t>(column.data()) % carom::kColumnAlignment == 0);
            bool zero = true;
            for (std::size_t row = rows; row < carom::padded(rows); ++row) zero = zero && column[row] == 0.0f;
            CHECK(zero);
            if ((rows - 1) % carom::kRowPadding != 0 && rows > 0) {
                column.resize(rows - 1);
                CHECK(column.data()[rows - 1] == 0.0f);
            }
        }
    }

    TEST_CASE("memory is kept once a column has been that large") {
        Column<double> column(1000);
        const double* before = column.data();
        column.resize(10);
        column.resize_for_overwrite(1000);
        CHECK(column.data() == before);
        CHECK(column.bytes() == carom::padded(1000) * sizeof(double));
    }

    TEST_CASE("push_back keeps what was there, and copies are independent") {
        Column<std::int32_t> column;
        for (std::int32_t i = 0; i < 100; ++i) column.push_back(i);
        Column<std::int32_t> copy = column;
        column[5] = -1;
        CHECK(copy.size() == 100);
        CHECK(copy[5] == 5);
        CHECK(copy[99] == 99);
    }

    TEST_CASE("a copy goes into the memory that is there, and clears the rest") {
        Column<std::int32_t> column(1000);
        for (std::int32_t& row : column) row = 7;
        const std::int32_t* before = column.data();
        Column<std::int32_t> shorter(3);
        shorter[2] = 5;
        column = shorter;
        CHECK(column.data() == before);
        CHECK(column.size() == 3);
        CHECK(column[2] == 5);
        for (std::size_t row = 3; row < carom::held(3); ++row) CHECK(column.data()[row] == 0);
        const auto& itself = column;
        column = itself;
        CHECK(column[2] == 5);
        CHECK(column.size() == 3);
    }
}

}  // namespace test_column

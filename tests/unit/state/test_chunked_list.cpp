#include "state/columns/chunked_list.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace test_chunked_list {

using namespace carom;

TEST_SUITE("state/chunked_list") {
    TEST_CASE("chunks are joined in order, without what lies beyond the rows") {
        ChunkedList list;
        list.prepare(100, 32);  // four chunks; the last has four rows and padding
        for (std::size_t chunk = 0; chunk < 4; ++chunk) {
            for (std::int32_t i = 0; i < 32; ++i)
                list.part(chunk)[i] = static_cast<std::int32_t>(32 * chunk) + i;
            list.set_count(chunk, 32);
        }
        std::vector<std::int32_t> joined;
        list.for_each_below(100, [&](std::int32_t number) { joined.push_back(number); });
        REQUIRE(joined.size() == 100);
        for (std::int32_t i = 0; i < 100; ++i) CHECK(joined[static_cast<std::size_t>(i)] == i);
    }
    TEST_CASE("few rows need no room for a whole chunk") {
        ChunkedList list;
        list.prepare(10, 2048);
        CHECK(list.bytes() < 4 * kRowPadding * sizeof(std::int32_t));
    }
}

}  // namespace test_chunked_list

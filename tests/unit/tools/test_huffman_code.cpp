#include "results/huffman_code.hpp"

#include <doctest/doctest.h>

#include <random>

namespace test_huffman_code {

using namespace carom::tool;

namespace {

using Frequency = std::array<std::uint32_t, kLiteralSymbols>;

/// 1 for a complete prefix code: every string of bits means something.
double kraft_sum(const HuffmanCode& code) {
    double sum = 0;
    for (const std::uint8_t length : code.length)
        if (length > 0) sum += 1.0 / static_cast<double>(1u << length);
    return sum;
}

}  // namespace

TEST_SUITE("tools/huffman_code") {
    TEST_CASE("frequent symbols get short codes") {
        Frequency frequency{};
        frequency[0] = 8, frequency[1] = 4, frequency[7] = 2, frequency[256] = 2;
        const HuffmanCode code = make_huffman_code(frequency);
        CHECK(code.length[0] == 1);
        CHECK(code.length[1] == 2);
        CHECK(code.length[7] == 3);
        CHECK(code.length[256] == 3);
        CHECK(code.length[2] == 0);
        CHECK(code.bits[0] == 0b0);  // canonical: 0, 10, 110, 111, first bit lowest
        CHECK(code.bits[1] == 0b01);
        CHECK(code.bits[7] == 0b011);
        CHECK(code.bits[256] == 0b111);
    }

    TEST_CASE("two symbols get a bit each") {
        Frequency frequency{};
        frequency[200] = 1000000, frequency[256] = 1;
        const HuffmanCode code = make_huffman_code(frequency);
        CHECK(code.length[200] == 1);
        CHECK(code.length[256] == 1);
    }

    TEST_CASE("no code is longer than deflate allows, and every code is complete") {
        Frequency fibonacci{};  // the deepest tree there is
        fibonacci[0] = fibonacci[1] = 1;
        for (std::size_t i = 2; i < 40; ++i) fibonacci[i] = fibonacci[i - 1] + fibonacci[i - 2];
        std::mt19937 random(5);
        for (int round = 0; round < 200; ++round) {
            const HuffmanCode code = make_huffman_code(fibonacci);
            for (const std::uint8_t length : code.length) CHECK(length <= kLongestCode);
            CHECK(kraft_sum(code) == 1);
            for (std::uint32_t& value : fibonacci)
                value = static_cast<std::uint32_t>(random() % 3 == 0 ? random() >> random() % 32 >> 8 : 0);
            fibonacci[256] = 1, fibonacci[0] = 5;
        }
    }
}

}  // namespace test_huffman_code

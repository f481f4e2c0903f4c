#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace carom::tool {

inline constexpr std::size_t kLiteralSymbols = 286;  // bytes, end of block, 29 classes of match lengths
inline constexpr int kLongestCode = 15;              // bits, deflate's limit

/// A canonical prefix code as deflate has it (RFC 1951, 3.2.2): symbols that do not occur have length 0.
struct HuffmanCode {
    std::array<std::uint8_t, kLiteralSymbols> length{};  // bits
    std::array<std::uint16_t, kLiteralSymbols> bits{};   // first bit lowest, ready to be written
};

/// The code with the fewest bits for these frequencies, none longer than kLongestCode.
/// @param frequency  at least two symbols occur
HuffmanCode make_huffman_code(std::span<const std::uint32_t, kLiteralSymbols> frequency);

}  // namespace carom::tool

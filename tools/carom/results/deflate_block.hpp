#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "results/bit_writer.hpp"
#include "results/huffman_code.hpp"

namespace carom::tool {

/// A run of bytes on its way into a deflate stream (RFC 1951): first taken apart into tokens, which are
/// bytes, runs, or matches a fixed distance before; then written with the prefix code that suits them.
class DeflateBlock {
  public:
    /// @param distance  where matches are looked for besides runs: bytes that go before, 0 for none
    void match(std::span<const std::byte> bytes, std::size_t distance);
    /// Every byte is a token.
    void list(std::span<const std::byte> bytes);

    /// Writes the tokens, unless that might take more room than the bytes themselves.
    bool put(BitWriter& output) const;
    static void put_stored(BitWriter& output, std::span<const std::byte> bytes);
    /// Room that `size` bytes can take in a stream, however they are written.
    static std::size_t largest_size(std::size_t size);

  private:
    void clear(std::size_t size, std::size_t distance);
    std::size_t largest_bits(const HuffmanCode& code) const;
    BitWriter put_code(BitWriter output, const HuffmanCode& code) const;
    BitWriter put_tokens(BitWriter output, const HuffmanCode& code) const;

    std::vector<std::uint32_t> tokens_;
    std::array<std::uint32_t, kLiteralSymbols> frequency_{};
    std::size_t size_ = 0;            // bytes the tokens stand for
    std::size_t distance_ = 0;        // of matches; 0: none
    std::size_t distance_class_ = 0;  // deflate's symbol for it
};

}  // namespace carom::tool

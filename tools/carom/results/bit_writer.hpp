#pragma once

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

namespace carom::tool {

/// Writes the bits of a deflate stream, the lowest first, to memory that has room for them and for eight
/// bytes more. A value: a loop that writes much works on a copy, which the compiler keeps in registers.
class BitWriter {
  public:
    explicit BitWriter(std::byte* at) : at_(at) {}

    /// @param bits  at most 56; `value` has no bits above
    void put(std::uint64_t value, int bits) {
        assert(bits >= 0 && bits <= 56 && value >> bits == 0);
        pending_ |= value << pending_bits_;
        pending_bits_ += bits;
        std::memcpy(at_, &pending_, sizeof pending_);  // every machine it runs on is little-endian
        const int bytes = pending_bits_ / 8;           // at most 7
        at_ += bytes;
        pending_ >>= 8 * bytes;
        pending_bits_ %= 8;
    }

    void align_to_byte() {
        if (pending_bits_ > 0) put(0, 8 - pending_bits_);
    }

    /// Whole bytes; only after `align_to_byte`.
    void put_bytes(std::span<const std::byte> bytes) {
        assert(pending_bits_ == 0);
        std::memcpy(at_, bytes.data(), bytes.size());
        at_ += bytes.size();
    }

    /// Where the next whole byte goes.
    const std::byte* end() const { return at_; }

  private:
    std::byte* at_;
    std::uint64_t pending_ = 0;
    int pending_bits_ = 0;  // below 8 between calls
};

}  // namespace carom::tool

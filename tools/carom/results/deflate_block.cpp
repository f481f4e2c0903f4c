#include "results/deflate_block.hpp"

#include <algorithm>
#include <cstring>

namespace carom::tool {
namespace {

constexpr std::size_t kShortestMatch = 4;  // deflate's is 3, which gains nothing over bytes
constexpr std::size_t kLongestMatch = 258;
constexpr std::size_t kLongestDistance = 32768;
constexpr std::size_t kLongestStored = 65535;
constexpr std::uint32_t kEndOfBlock = 256;

// A token is a byte, or a match: these flags and its length. A match is a run unless it is at the distance.
constexpr std::uint32_t kMatch = 1u << 31, kAtDistance = 1u << 30, kLengthMask = 0xffff;

/// Symbols of lengths and distances (RFC 1951, 3.2.5) stand for classes of values: the first one, and how
/// many bits tell which of those up to the next class is meant.
struct ValueClass {
    std::uint32_t first;
    int extra_bits;
};

/// `plain` classes of one value, then `repeat` classes of two, of four, ...
template <std::size_t kCount>
constexpr std::array<ValueClass, kCount> make_classes(std::uint32_t first, int plain, int repeat) {
    std::array<ValueClass, kCount> classes{};
    for (int i = 0; i < static_cast<int>(kCount); ++i) {
        const int bits = i < plain ? 0 : (i - plain) / repeat + 1;
        classes[static_cast<std::size_t>(i)] = {first, bits};
        first += 1u << bits;
    }
    return classes;
}

constexpr auto kDistances = make_classes<30>(1, 4, 2);
constexpr auto kLengths = [] {
    auto classes = make_classes<29>(3, 8, 4);
    classes[28] = {kLongestMatch, 0};  // the standard's one exception
    return classes;
}();

constexpr auto kClassOfLength = [] {
    std::array<std::uint8_t, kLongestMatch + 1> class_of{};
    for (std::size_t length = 3; length <= kLongestMatch; ++length)
        for (std::size_t i = 0; i < kLengths.size(); ++i)
            if (kLengths[i].first <= length) class_of[length] = static_cast<std::uint8_t>(i);
    return class_of;
}();

std::size_t class_of_distance(std::size_t distance) {
    std::size_t found = 0;
    while (found + 1 < kDistances.size() && kDistances[found + 1].first <= distance) ++found;
    return found;
}

std::size_t symbol_of_length(std::size_t length) {
    return kEndOfBlock + 1 + kClassOfLength[length];
}

std::uint32_t load4(const std::byte* bytes) {
    std::uint32_t value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

/// Bytes from `at` on that equal those `distance` before, at most kLongestMatch and none from `end` on.
std::size_t match_length(const std::byte* at, const std::byte* end, std::size_t distance) {
    const std::size_t limit = std::min(static_cast<std::size_t>(end - at), kLongestMatch);
    std::size_t length = 0;
    while (length + 8 <= limit && std::memcmp(at + length, at + length - distance, 8) == 0) length += 8;
    while (length < limit && at[length] == *(at + length - distance)) ++length;
    return length;
}

}  // namespace

void DeflateBlock::clear(std::size_t size, std::size_t distance) {
    tokens_.resize(size);
    frequency_.fill(0);
    frequency_[kEndOfBlock] = 1;
    size_ = size;
    distance_ = distance > 1 && distance <= kLongestDistance ? distance : 0;
    distance_class_ = distance_ > 0 ? class_of_distance(distance_) : 1;  // 1: never used, completes the code
}

void DeflateBlock::match(std::span<const std::byte> bytes, std::size_t distance) {
    clear(bytes.size(), distance);
    const std::byte* const begin = bytes.data();
    const std::byte* const end = begin + bytes.size();
    // From the first of these on there is something a distance before, to the last four bytes are left.
    const std::byte* const has_before = distance_ > 0 && distance_ < size_ ? begin + distance_ : end;
    const std::byte* const has_four = size_ >= kShortestMatch ? end - kShortestMatch : begin - 1;
    std::uint32_t* token = tokens_.data();
    const auto add_match = [&](std::size_t length, std::uint32_t flags) {
        *token++ = kMatch | flags | static_cast<std::uint32_t>(length);
        ++frequency_[symbol_of_length(length)];
        return length;
    };
    for (const std::byte* at = begin; at < end;) {
        if (at >= has_before && at <= has_four && load4(at) == load4(at - distance_)) {
            at += add_match(match_length(at, end, distance_), kAtDistance);
        } else if (at > begin && at <= has_four && load4(at) == load4(at - 1)) {
            at += add_match(match_length(at, end, 1), 0);
        } else {
            *token = std::to_integer<std::uint32_t>(*at++);
            ++frequency_[*token++];
        }
    }
    tokens_.resize(static_cast<std::size_t>(token - tokens_.data()));
}

void DeflateBlock::list(std::span<const std::byte> bytes) {
    clear(bytes.size(), 0);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        tokens_[i] = std::to_integer<std::uint32_t>(bytes[i]);
        ++frequency_[tokens_[i]];
    }
}

/// What the block takes if every match is at the distance.
std::size_t DeflateBlock::largest_bits(const HuffmanCode& code) const {
    constexpr std::size_t kHeaderBits = 3 + 14 + 3 * 19 + 4 * (kLiteralSymbols + kDistances.size());
    std::size_t bits = kHeaderBits;
    for (std::size_t symbol = 0; symbol < kLiteralSymbols; ++symbol) {
        int each = code.length[symbol];
        if (symbol > kEndOfBlock)
            each +=
                kLengths[symbol - kEndOfBlock - 1].extra_bits + 1 + kDistances[distance_class_].extra_bits;
        bits += frequency_[symbol] * static_cast<std::size_t>(each);
    }
    return bits;
}

/// The block's header, with the lengths of its codes (RFC 1951, 3.2.7).
BitWriter DeflateBlock::put_code(BitWriter output, const HuffmanCode& code) const {
    constexpr int kDynamicBlock = 0b100;  // not the last; type 2
    constexpr int kLengthOrder[] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
    const std::size_t distances = distance_class_ + 1;
    output.put(kDynamicBlock, 3);
    output.put(kLiteralSymbols - 257, 5);
    output.put(distances - 1, 5);
    output.put(std::size(kLengthOrder) - 4, 4);
    // Lengths are written as they are: sixteen symbols of four bits each are a complete code.
    for (const int length : kLengthOrder) output.put(length <= kLongestCode ? 4 : 0, 3);
    const auto put_length = [&output](unsigned length) {  // codes go highest bit first
        output.put((length & 1) << 3 | (length & 2) << 1 | (length & 4) >> 1 | (length & 8) >> 3, 4);
    };
    for (const std::uint8_t length : code.length) put_length(length);
    for (std::size_t i = 0; i < distances; ++i) put_length(i == 0 || i == distance_class_ ? 1 : 0);
    return output;
}

BitWriter DeflateBlock::put_tokens(BitWriter output, const HuffmanCode& code) const {
    const ValueClass& distance = kDistances[distance_class_];
    const std::uint64_t at_distance = 1 | (distance_ > 0 ? distance_ - distance.first : 0) << 1;
    for (const std::uint32_t token : tokens_) {
        if (token < kEndOfBlock) {
            output.put(code.bits[token], code.length[token]);
            continue;
        }
        const std::uint32_t length = token & kLengthMask;
        const ValueClass& length_class = kLengths[kClassOfLength[length]];
        const std::size_t symbol = symbol_of_length(length);
        // At most 15 + 5 + 14 bits: symbol, which length of its class, distance.
        int bits = code.length[symbol];
        std::uint64_t value = code.bits[symbol] | std::uint64_t{length - length_class.first} << bits;
        bits += length_class.extra_bits;
        if (token & kAtDistance) value |= at_distance << bits;
        output.put(value, bits + (token & kAtDistance ? 1 + distance.extra_bits : 1));
    }
    output.put(code.bits[kEndOfBlock], code.length[kEndOfBlock]);
    return output;
}

bool DeflateBlock::put(BitWriter& output) const {
    if (tokens_.empty()) return false;
    const HuffmanCode code = make_huffman_code(frequency_);
    if (largest_bits(code) / 8 + 1 > size_) return false;
    output = put_tokens(put_code(output, code), code);
    return true;
}

std::size_t DeflateBlock::largest_size(std::size_t size) {
    return size + 6 * (size / kLongestStored + 1);
}

void DeflateBlock::put_stored(BitWriter& output, std::span<const std::byte> bytes) {
    constexpr int kStoredBlock = 0;  // not the last; type 0
    while (!bytes.empty()) {
        const std::size_t size = std::min(bytes.size(), kLongestStored);
        output.put(kStoredBlock, 3);
        output.align_to_byte();
        output.put(size, 16);
        output.put(size ^ 0xffff, 16);
        output.put_bytes(bytes.first(size));
        bytes = bytes.subspan(size);
    }
}

}  // namespace carom::tool

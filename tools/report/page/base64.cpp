#include "report/page/base64.hpp"

#include <bit>
#include <cstdint>

namespace carom::report {

static_assert(std::endian::native == std::endian::little, "pages read arrays low byte first");

void append_base64(std::string& text, std::span<const std::byte> bytes) {
    static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    const std::size_t begin = text.size(), groups = (bytes.size() + 2) / 3;
    text.resize(begin + 4 * groups, '=');
    char* out = text.data() + begin;
    std::size_t i = 0;
    const auto byte = [&bytes](std::size_t at) { return std::to_integer<std::uint32_t>(bytes[at]); };
    for (; i + 3 <= bytes.size(); i += 3) {
        const std::uint32_t bits = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
        *out++ = kDigits[bits >> 18];
        *out++ = kDigits[bits >> 12 & 63];
        *out++ = kDigits[bits >> 6 & 63];
        *out++ = kDigits[bits & 63];
    }
    if (i == bytes.size()) return;
    const bool two = i + 2 == bytes.size();
    const std::uint32_t bits = byte(i) << 16 | (two ? byte(i + 1) << 8 : 0);
    *out++ = kDigits[bits >> 18];
    *out++ = kDigits[bits >> 12 & 63];
    if (two) *out++ = kDigits[bits >> 6 & 63];
}

}  // namespace carom::report

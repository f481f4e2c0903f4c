#pragma once

#include <carom/vec2.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

namespace carom::fuzz {

/// Hands out a fuzzer's bytes as numbers and choices, front to back; zeros when there are no more.
class ByteSource {
  public:
    explicit ByteSource(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    bool is_empty() const { return bytes_.empty(); }
    std::size_t left() const { return bytes_.size(); }

    std::uint8_t byte() {
        if (bytes_.empty()) return 0;
        const std::uint8_t first = bytes_.front();
        bytes_ = bytes_.subspan(1);
        return first;
    }
    std::uint32_t word() {
        const std::uint32_t low = byte();
        return low + 256u * byte();
    }
    /// 0 ... count - 1
    std::size_t below(std::size_t count) { return byte() % count; }
    bool flag() { return (byte() & 1) != 0; }
    /// True once in `rate` byte values.
    bool once_in(int rate) { return byte() % rate == rate - 1; }
    std::optional<bool> choice() {
        const std::size_t each = below(8);
        return each < 2 ? std::optional<bool>(each == 1) : std::nullopt;
    }

    /// Mostly an eighth of `scale` times -8 ... 7.9, now and then a number at an edge of what is allowed.
    double number(double scale) {
        constexpr double kLargest = std::numeric_limits<double>::max();
        constexpr double kInfinite = std::numeric_limits<double>::infinity();
        constexpr std::array kEdges{0.0,   -0.0,  1e-12, 1e-9, -1e-9, 1e-30, 5e-324,   1e7,       -1e7,
                                    1e8,   -1e8,  1e10,  1e30, 1e38,  1e39,  kLargest, kInfinite, -kInfinite,
                                    1e-38, 1e-45, 1.0,   -1.0, 1e3,   -1e3,  1e5,      1e6};
        const std::uint8_t first = byte();
        if (first < 200) return scale * (first - 100) / 12.5;
        if (first < 248) return scale * (static_cast<double>(word()) - 32768) / 4096;
        const std::size_t edge = byte();
        return edge < kEdges.size() ? kEdges[edge] : scale * std::numeric_limits<double>::quiet_NaN();
    }
    /// As number(), its size.
    double size(double scale) {
        const double value = number(scale);
        return value < 0 ? -value : value;
    }
    Vec2 point(double scale) {
        const double x = number(scale);
        return {x, number(scale)};
    }
    /// A number, or none.
    std::optional<double> some(double scale) {
        if (flag()) return std::nullopt;
        return number(scale);
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

}  // namespace carom::fuzz

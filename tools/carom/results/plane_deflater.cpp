#include "results/plane_deflater.hpp"

#include <zlib.h>

#include <array>
#include <cmath>
#include <cstdint>

namespace carom::tool {
namespace {

constexpr std::size_t kSampleSize = 4096;  // bytes: tells an entropy to 0.05 bits
constexpr double kNoiseEntropy = 7.0;      // bits a byte; above it frequencies gain less than an eighth
constexpr double kRepeatedPart = 0.1;      // of the bytes: below it, looking for matches does not pay

template <std::size_t kSize>
void shuffle(const std::byte* data, std::byte* planes, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t byte = 0; byte < kSize; ++byte) planes[byte * count + i] = data[i * kSize + byte];
}

double entropy_of(const std::array<std::uint32_t, 256>& frequency, double count) {
    double bits = 0;
    for (const std::uint32_t times : frequency)
        if (times > 0) bits -= times / count * std::log2(times / count);
    return bits;
}

}  // namespace

PlaneKind kind_of_plane(std::span<const std::byte> plane, std::size_t row) {
    const std::size_t stride = plane.size() / kSampleSize | 1;  // odd, so that x and y both count
    std::array<std::uint32_t, 256> frequency{};
    std::uint32_t samples = 0, runs = 0, compared = 0, repeated = 0;
    for (std::size_t i = 1; i < plane.size(); i += stride, ++samples) {
        ++frequency[std::to_integer<std::size_t>(plane[i])];
        runs += plane[i] == plane[i - 1] ? 1 : 0;
        if (i < row) continue;
        ++compared;
        repeated += plane[i] == plane[i - row] ? 1 : 0;
    }
    if (repeated > kRepeatedPart * compared || 2 * runs > samples) return PlaneKind::repeats;
    return entropy_of(frequency, samples) < kNoiseEntropy ? PlaneKind::uneven : PlaneKind::noise;
}

BitWriter PlaneDeflater::deflate_plane(BitWriter output, std::span<const std::byte> plane, std::size_t row) {
    const PlaneKind kind = kind_of_plane(plane, row);
    if (kind == PlaneKind::repeats) block_.match(plane, row);
    if (kind == PlaneKind::uneven) block_.list(plane);
    if (kind == PlaneKind::noise || !block_.put(output)) DeflateBlock::put_stored(output, plane);
    return output;
}

std::span<const std::byte> PlaneDeflater::compress(std::span<const std::byte> data, std::size_t element_size,
                                                   std::size_t row) {
    constexpr std::uint64_t kZlibHeader = 0x0178;     // deflate, window of 32 KiB, low effort
    constexpr std::uint64_t kLastEmptyBlock = 0b011;  // the last; type 1; its end is seven zeros
    const std::size_t count = data.size() / element_size;
    planes_.resize(data.size());
    if (element_size == sizeof(float))
        shuffle<sizeof(float)>(data.data(), planes_.data(), count);
    else
        shuffle<sizeof(double)>(data.data(), planes_.data(), count);

    constexpr std::size_t kAroundPlanes = 32;  // header, last block, sum, and what BitWriter asks for
    output_.resize(element_size * DeflateBlock::largest_size(count) + kAroundPlanes);
    BitWriter output(output_.data());
    output.put(kZlibHeader, 16);
    for (std::size_t plane = 0; plane < element_size; ++plane)
        output = deflate_plane(output, {planes_.data() + plane * count, count}, row);
    output.put(kLastEmptyBlock, 10);
    output.align_to_byte();
    const auto sum = static_cast<std::uint32_t>(
        adler32_z(1, reinterpret_cast<const Bytef*>(planes_.data()), planes_.size()));
    for (int shift = 24; shift >= 0; shift -= 8) output.put(sum >> shift & 0xff, 8);
    return {output_.data(), output.end()};
}

}  // namespace carom::tool

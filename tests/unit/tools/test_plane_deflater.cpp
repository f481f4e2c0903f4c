// What the deflater writes, undone by zlib and a plain un-shuffle: what HDF5's filters do when they read.
#include "results/plane_deflater.hpp"
#include "support/effort.hpp"

#include <doctest/doctest.h>
#include <zlib.h>

#include <cstring>
#include <random>
#include <vector>

namespace test_plane_deflater {

using namespace carom::tool;

namespace {

template <class Real>
std::vector<Real> read_back(std::span<const std::byte> compressed, std::size_t count) {
    std::vector<unsigned char> planes(count * sizeof(Real));
    auto size = static_cast<uLongf>(planes.size());
    const int result = uncompress(planes.data(), &size, reinterpret_cast<const Bytef*>(compressed.data()),
                                  static_cast<uLong>(compressed.size()));
    REQUIRE(result == Z_OK);
    REQUIRE(size == planes.size());
    std::vector<Real> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        unsigned char bytes[sizeof(Real)];
        for (std::size_t byte = 0; byte < sizeof(Real); ++byte) bytes[byte] = planes[byte * count + i];
        std::memcpy(&values[i], bytes, sizeof(Real));
    }
    return values;
}

enum class Content { zeros, noise, gas, gas_frames, repeated_frames, runs };
constexpr Content kContents[] = {Content::zeros,      Content::noise,           Content::gas,
                                 Content::gas_frames, Content::repeated_frames, Content::runs};

template <class Real>
std::vector<Real> make_values(Content content, std::size_t count, std::size_t row) {
    std::mt19937_64 random(11);
    std::vector<Real> values(count, Real{0});
    for (std::size_t i = 0; i < count; ++i) {
        if (content == Content::gas) values[i] = static_cast<Real>(std::normal_distribution<>(0, 2)(random));
        if (content == Content::gas_frames)  // one body in eight was hit since the frame before
            values[i] = i < row || random() % 8 == 0
                            ? static_cast<Real>(std::normal_distribution<>(0, 2)(random))
                            : values[i - row];
        if (content == Content::runs && i > 0)
            values[i] = random() % 50 == 0 ? static_cast<Real>(i) : values[i - 1];
        if (content == Content::noise) {
            const std::uint64_t bits = random();
            std::memcpy(&values[i], &bits, sizeof(Real));
        }
        if (content == Content::repeated_frames)
            values[i] = i < row ? static_cast<Real>(std::uniform_real_distribution<>(0, 100)(random))
                                : values[i - row];
    }
    return values;
}

template <class Real>
std::size_t compressed_size(PlaneDeflater& deflater, Content content, std::size_t count, std::size_t row) {
    const std::vector<Real> values = make_values<Real>(content, count, row);
    const std::span<const std::byte> compressed =
        deflater.compress(std::as_bytes(std::span(values)), sizeof(Real), row);
    const std::vector<Real> again = read_back<Real>(compressed, count);
    CHECK(std::memcmp(values.data(), again.data(), count * sizeof(Real)) == 0);  // NaNs have bits too
    return compressed.size();
}

}  // namespace

TEST_SUITE("tools/plane_deflater") {
    TEST_CASE("every chunk reads back bit for bit, whatever its content and size, from one deflater") {
        PlaneDeflater deflater;
        for (const std::size_t count :
             {1u, 2u, 3u, 7u, 255u, 259u, 1000u, 20000u, 65536u, 70001u, carom::test::scaled(131072u, 131u)})
            for (const Content content : kContents)
                for (const std::size_t row :
                     {count, std::max<std::size_t>(1, count / 4), std::size_t{1}, std::size_t{2}}) {
                    if (carom::test::is_effort_reduced() && count > 10'000 && row != count / 4) continue;
                    CAPTURE(count);
                    CAPTURE(row);
                    compressed_size<float>(deflater, content, count, row);
                    compressed_size<double>(deflater, content, count, row);
                }
    }

    TEST_CASE("what can be compressed is, and noise costs under 1 % more") {
        PlaneDeflater deflater;
        constexpr std::size_t kCount = 40000, kBytes = kCount * sizeof(float);
        CHECK(compressed_size<float>(deflater, Content::zeros, kCount, kCount) < kBytes / 100);
        CHECK(compressed_size<float>(deflater, Content::repeated_frames, kCount, kCount / 20) < kBytes / 8);
        CHECK(compressed_size<float>(deflater, Content::runs, kCount, kCount) < kBytes / 8);
        CHECK(compressed_size<float>(deflater, Content::noise, kCount, kCount) < kBytes * 101 / 100);
        CHECK(compressed_size<float>(deflater, Content::gas, kCount, kCount) < kBytes * 9 / 10);
        CHECK(compressed_size<float>(deflater, Content::gas_frames, kCount, kCount / 4) < kBytes / 2);
    }

    TEST_CASE("a gas is compressed within 1,000 bytes of zlib at its fastest, or better") {
        PlaneDeflater deflater;
        constexpr std::size_t kCount = 40000;
        for (const Content content : {Content::gas, Content::gas_frames, Content::zeros}) {
            const std::vector<float> values = make_values<float>(content, kCount, kCount / 4);
            std::vector<unsigned char> planes(kCount * sizeof(float)), output(compressBound(kCount * 4));
            const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
            for (std::size_t i = 0; i < planes.size(); ++i) planes[i % 4 * kCount + i / 4] = bytes[i];
            auto size = static_cast<uLongf>(output.size());
            REQUIRE(compress2(output.data(), &size, planes.data(), planes.size(), 1) == Z_OK);
            CHECK(compressed_size<float>(deflater, content, kCount, kCount / 4) < size + 1000);
        }
    }
}

}  // namespace test_plane_deflater

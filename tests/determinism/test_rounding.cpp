// Rounding to single precision happens where the source says so. gcc 12.2 at -O2 skips it in the first case
// below unless it is told not to vectorize straight-line code; that cost the ledger its equal bits across
// compilers.
#include <doctest/doctest.h>

#include <array>
#include <cstddef>

namespace test_rounding {

namespace {

struct Pair {
    double x, y;
};

[[gnu::noinline]] Pair store_and_read_back(float* floats, Pair value) {
    floats[0] = static_cast<float>(value.x), floats[1] = static_cast<float>(value.y);
    return {floats[0], floats[1]};
}

template <std::size_t kCount>
[[gnu::noinline]] void store_and_read_back(std::array<float, kCount>& floats,
                                           const std::array<double, kCount>& values,
                                           std::array<double, kCount>& again) {
    for (std::size_t i = 0; i < kCount; ++i) floats[i] = static_cast<float>(values[i]);
    for (std::size_t i = 0; i < kCount; ++i) again[i] = static_cast<double>(floats[i]);
}

template <std::size_t kCount>
void check_count() {
    std::array<float, kCount> floats{};
    std::array<double, kCount> values{}, again{};
    for (std::size_t i = 0; i < kCount; ++i) values[i] = 0.1 * static_cast<double>(i + 1);
    store_and_read_back(floats, values, again);
    for (std::size_t i = 0; i < kCount; ++i) {
        const volatile float rounded = floats[i];
        CHECK(again[i] == static_cast<double>(rounded));
    }
}

}  // namespace

TEST_SUITE("determinism/rounding") {
    TEST_CASE("a double stored as float and read back is rounded") {
        float floats[2] = {};
        const Pair again = store_and_read_back(floats, {0.1, 0.3});
        CHECK(again.x == static_cast<double>(0.1f));
        CHECK(again.y == static_cast<double>(0.3f));
        check_count<2>();
        check_count<3>();
        check_count<4>();
        check_count<8>();
        check_count<17>();
        check_count<100>();
    }
}

}  // namespace test_rounding

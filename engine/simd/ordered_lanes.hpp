#pragma once

#include <cstddef>
#include <cstdint>

#include "simd/consecutive_rows.hpp"

// Lanes for batches of pairs of rows that lie in memory as they are counted. Of row numbers they read only
// the first, and records come and go by whole registers where the instruction set can sort them
// (load_run4 and others in avx512_lanes.hpp): most of what a kernel does with two bodies is to fetch them.

namespace carom::simd {
namespace {

/// Every second row, counted from the first.
alignas(64) constexpr std::int32_t kEverySecond[16] = {0,  2,  4,  6,  8,  10, 12, 14,
                                                       16, 18, 20, 22, 24, 26, 28, 30};

/// Rows a are consecutive, and so are rows b; the two have nothing to do with each other.
template <class Base>
struct LanesOfRuns : Base {
    using Number = typename Base::Number;
    using Batch2 = typename Base::Batch2;
    using Batch4 = typename Base::Batch4;

    [[gnu::always_inline]] static Batch2 load_rows2(const Number* packed, const std::int32_t* rows) {
        packed += 2 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::load_run2(packed); }) return Base::load_run2(packed);
        else return Base::load_rows2(packed, kConsecutive);
    }
    [[gnu::always_inline]] static void store_rows2(Number* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        packed += 2 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::store_run2(packed, values); }) Base::store_run2(packed, values);
        else Base::store_rows2(packed, kConsecutive, values);
    }
    [[gnu::always_inline]] static Batch4 load_rows4(const Number* packed, const std::int32_t* rows) {
        packed += 4 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::load_run4(packed); }) return Base::load_run4(packed);
        else return Base::load_rows4(packed, kConsecutive);
    }
    [[gnu::always_inline]] static void store_rows4(Number* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        packed += 4 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::store_run4(packed, values); }) Base::store_run4(packed, values);
        else Base::store_rows4(packed, kConsecutive, values);
    }
    [[gnu::always_inline]] static auto gather_at(const Number* column, const std::int32_t* rows) {
        return Base::load_unaligned(column + *rows);
    }
};

/// Rows a are every second one, and rows b those between: a, b, a, b ... Both are loaded and stored at once.
template <class Base>
struct LanesOfPairs : Base {
    using Number = typename Base::Number;
    using Batch2 = typename Base::Batch2;
    using Batch4 = typename Base::Batch4;
    static constexpr bool kPairs = true;

    [[gnu::always_inline]] static void load_pairs2(const Number* packed, const std::int32_t* rows, Batch2& a,
                                                   Batch2& b) {
        packed += 2 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::load_run4(packed); }) {
            const Batch4 both = Base::load_run4(packed);
            a = {{both[0], both[1]}}, b = {{both[2], both[3]}};
        } else {
            a = Base::load_rows2(packed, kEverySecond), b = Base::load_rows2(packed + 2, kEverySecond);
        }
    }
    [[gnu::always_inline]] static void store_pairs2(Number* packed, const std::int32_t* rows, const Batch2& a,
                                                    const Batch2& b) {
        packed += 2 * static_cast<std::ptrdiff_t>(*rows);
        const Batch4 both{{a[0], a[1], b[0], b[1]}};
        if constexpr (requires { Base::store_run4(packed, both); }) Base::store_run4(packed, both);
        else Base::store_rows2(packed, kEverySecond, a), Base::store_rows2(packed + 2, kEverySecond, b);
    }
    [[gnu::always_inline]] static void load_pairs4(const Number* packed, const std::int32_t* rows, Batch4& a,
                                                   Batch4& b) {
        packed += 4 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::load_pairs4(packed, a, b); }) Base::load_pairs4(packed, a, b);
        else a = Base::load_rows4(packed, kEverySecond), b = Base::load_rows4(packed + 4, kEverySecond);
    }
    [[gnu::always_inline]] static void store_pairs4(Number* packed, const std::int32_t* rows, const Batch4& a,
                                                    const Batch4& b) {
        packed += 4 * static_cast<std::ptrdiff_t>(*rows);
        if constexpr (requires { Base::store_pairs4(packed, a, b); }) Base::store_pairs4(packed, a, b);
        else Base::store_rows4(packed, kEverySecond, a), Base::store_rows4(packed + 4, kEverySecond, b);
    }
    [[gnu::always_inline]] static auto gather_at(const Number* column, const std::int32_t* rows) {
        return Base::gather_at(column + *rows, kEverySecond);
    }
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include "simd/batch.hpp"
#include "simd/scalar_lanes.hpp"

#include <immintrin.h>
#include <array>

namespace carom::simd {
namespace {

/// Row `bits` lists the lanes whose bit is set, in order; the rest do not matter.
template <std::size_t kLanes>
using CompressTable = std::array<std::array<std::uint8_t, 8>, std::size_t{1} << kLanes>;

template <std::size_t kLanes>
constexpr CompressTable<kLanes> make_compress_table() {
    CompressTable<kLanes> table{};
    for (std::size_t bits = 0; bits < table.size(); ++bits) {
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < kLanes; ++lane)
            if ((bits >> lane) & 1u) table[bits][count++] = static_cast<std::uint8_t>(lane);
    }
    return table;
}

constexpr CompressTable<8> kCompress8 = make_compress_table<8>();  // 2 KiB
constexpr CompressTable<4> kCompress4 = make_compress_table<4>();

inline __m256i compress_order8(unsigned bits) {
    return _mm256_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&kCompress8[bits])));
}
inline __m128i compress_order4(unsigned bits) {
    return _mm_cvtepu8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(&kCompress4[bits])));
}

inline unsigned bitmask(xsimd::batch_bool<float, xsimd::avx2> mask) {
    return static_cast<unsigned>(_mm256_movemask_ps(mask));
}
inline unsigned bitmask(xsimd::batch_bool<double, xsimd::avx2> mask) {
    return static_cast<unsigned>(_mm256_movemask_pd(mask));
}

inline void store_smallest4_of_quads(std::int32_t* to, __m128i a, __m128i b, __m128i c, __m128i d) {
    const __m128i ab = _mm_min_epi32(_mm_unpacklo_epi32(a, b), _mm_unpackhi_epi32(a, b));
    const __m128i cd = _mm_min_epi32(_mm_unpacklo_epi32(c, d), _mm_unpackhi_epi32(c, d));
    const __m128i all = _mm_min_epi32(_mm_unpacklo_epi64(ab, cd), _mm_unpackhi_epi64(ab, cd));
    _mm_storeu_si128(reinterpret_cast<__m128i*>(to), all);
}

template <>
struct Lanes<float, xsimd::avx2> : BatchLanes<float, xsimd::avx2> {
    using Rows = __m256i;

    static Rows broadcast_row(std::int32_t row) { return _mm256_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    }
    static void store_rows(std::int32_t* to, Rows rows) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), rows);
    }
    static Rows rows_sum(Rows a, Rows b) { return _mm256_add_epi32(a, b); }

    static Rows rows_difference(Rows a, Rows b) { return _mm256_sub_epi32(a, b); }
    static Rows rows_min(Rows a, Rows b) { return _mm256_min_epi32(a, b); }
    static constexpr auto store_marked_pairs = &store_marked_pairs_one_by_one;
    static void store_smallest4(std::int32_t* to, Rows a, Rows b, Rows c, Rows d) {
        const auto quad = [](Rows rows) {
            return _mm_min_epi32(_mm256_castsi256_si128(rows), _mm256_extracti128_si256(rows, 1));
        };
        store_smallest4_of_quads(to, quad(a), quad(b), quad(c), quad(d));
    }

    // xsimd 8.1 emulates float gathers lane by lane.
    static Batch gather(const float* column, Rows rows) {
        return Batch::Raw(_mm256_i32gather_ps(column, rows, sizeof(float)));
    }

    static Batch gather_at(const float* column, const std::int32_t* rows) {
        const auto pair = [&](int i) {
            return _mm_insert_ps(_mm_load_ss(column + rows[i]), _mm_load_ss(column + rows[i + 1]), 0x10);
        };
        const __m128 low = _mm_movelh_ps(pair(0), pair(2)), high = _mm_movelh_ps(pair(4), pair(6));
        return Batch::Raw(_mm256_insertf128_ps(_mm256_castps128_ps256(low), high, 1));
    }

    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        store_rows(out, _mm256_permutevar8x32_epi32(values, compress_order8(bits)));
        return static_cast<std::size_t>(__builtin_popcount(bits));
    }
    static void compress_store(float* out, Batch values, unsigned bits) {
        _mm256_storeu_ps(out, _mm256_permutevar8x32_ps(values.raw, compress_order8(bits)));
    }

    // Records are always inlined: left to itself gcc stops doing so once enough kernels use them, and a gas
    // takes 6 % more instructions (tools/count_instructions).
    [[gnu::always_inline]] static Batch2 load_rows2(const float* packed, const std::int32_t* rows) {
        const auto two = [&](int first, int second) {
            const __m128 low = load_pair(packed + 2 * static_cast<std::ptrdiff_t>(rows[first]));
            const __m128 high = load_pair(packed + 2 * static_cast<std::ptrdiff_t>(rows[second]));
            return _mm_movelh_ps(low, high);
        };
        const __m256 ab = _mm256_insertf128_ps(_mm256_castps128_ps256(two(0, 1)), two(4, 5), 1);
        const __m256 cd = _mm256_insertf128_ps(_mm256_castps128_ps256(two(2, 3)), two(6, 7), 1);
        return {{Batch::Raw(_mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(2, 0, 2, 0))),
                 Batch::Raw(_mm256_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 1, 3, 1)))}};
    }
    [[gnu::always_inline]] static void store_rows2(float* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        const __m256 ab = _mm256_unpacklo_ps(values[0].raw, values[1].raw);
        const __m256 cd = _mm256_unpackhi_ps(values[0].raw, values[1].raw);
        store_two(packed, rows[0], rows[1], _mm256_castps256_ps128(ab));
        store_two(packed, rows[2], rows[3], _mm256_castps256_ps128(cd));
        store_two(packed, rows[4], rows[5], _mm256_extractf128_ps(ab, 1));
        store_two(packed, rows[6], rows[7], _mm256_extractf128_ps(cd, 1));
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const float* packed, const std::int32_t* rows) {
        return transposed(two_records(packed, rows, 0), two_records(packed, rows, 1),
                          two_records(packed, rows, 2), two_records(packed, rows, 3));
    }
    static Batch4 load_differences4(const float* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto difference = [&](int i) {
            return _mm256_sub_ps(two_records(packed, of, i), two_records(packed, from, i));
        };
        return transposed(difference(0), difference(1), difference(2), difference(3));
    }
    [[gnu::always_inline]] static void store_rows4(float* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        const Batch4 records = transposed(values[0].raw, values[1].raw, values[2].raw, values[3].raw);
        for (int i = 0; i < 4; ++i)
            _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]),
                          _mm256_castps256_ps128(records.lane[i].raw));
        for (int i = 0; i < 4; ++i)
            _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[i + 4]),
                          _mm256_extractf128_ps(records.lane[i].raw, 1));
    }

  private:
    /// The records of rows i and i + 4.
    static __m256 two_records(const float* packed, const std::int32_t* rows, int i) {
        const __m128 first = _mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]));
        const __m128 second = _mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[i + 4]));
        return _mm256_insertf128_ps(_mm256_castps128_ps256(first), second, 1);
    }

    static __m128 load_pair(const float* pair) {
        return _mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(pair)));
    }
    static void store_two(float* packed, std::int32_t first, std::int32_t second, __m128 values) {
        const auto to = [&](std::int32_t row) {
            return reinterpret_cast<__m64*>(packed + 2 * static_cast<std::ptrdiff_t>(row));
        };
        _mm_storel_pi(to(first), values), _mm_storeh_pi(to(second), values);
    }

    /// 4 x 4 in each 128-bit half.
    [[gnu::always_inline]] static Batch4 transposed(__m256 a, __m256 b, __m256 c, __m256 d) {
        const __m256d ab_low = _mm256_castps_pd(_mm256_unpacklo_ps(a, b));
        const __m256d ab_high = _mm256_castps_pd(_mm256_unpackhi_ps(a, b));
        const __m256d cd_low = _mm256_castps_pd(_mm256_unpacklo_ps(c, d));
        const __m256d cd_high = _mm256_castps_pd(_mm256_unpackhi_ps(c, d));
        return {{Batch::Raw(_mm256_castpd_ps(_mm256_unpacklo_pd(ab_low, cd_low))),
                 Batch::Raw(_mm256_castpd_ps(_mm256_unpackhi_pd(ab_low, cd_low))),
                 Batch::Raw(_mm256_castpd_ps(_mm256_unpacklo_pd(ab_high, cd_high))),
                 Batch::Raw(_mm256_castpd_ps(_mm256_unpackhi_pd(ab_high, cd_high)))}};
    }
};

template <>
struct Lanes<double, xsimd::avx2> : BatchLanes<double, xsimd::avx2> {
    using Rows = __m128i;

    static Rows broadcast_row(std::int32_t row) { return _mm_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
    }
    static void store_rows(std::int32_t* to, Rows rows) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to), rows);
    }
    static Rows rows_sum(Rows a, Rows b) { return _mm_add_epi32(a, b); }

    static Batch gather(const double* column, Rows rows) {
        return Batch::Raw(_mm256_i32gather_pd(column, rows, sizeof(double)));
    }

    static Batch gather_at(const double* column, const std::int32_t* rows) {
        const auto pair = [&](int i) {
            return _mm_loadh_pd(_mm_load_sd(column + rows[i]), column + rows[i + 1]);
        };
        return Batch::Raw(_mm256_insertf128_pd(_mm256_castpd128_pd256(pair(0)), pair(2), 1));
    }

    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        const __m128 compressed = _mm_permutevar_ps(_mm_castsi128_ps(values), compress_order4(bits));
        store_rows(out, _mm_castps_si128(compressed));
        return static_cast<std::size_t>(__builtin_popcount(bits));
    }
    static void compress_store(double* out, Batch values, unsigned bits) {
        // Lane k is the floats 2 k and 2 k + 1.
        const __m256i lanes = _mm256_cvtepi32_epi64(_mm_slli_epi32(compress_order4(bits), 1));
        const __m256i halves =
            _mm256_or_si256(lanes, _mm256_slli_epi64(_mm256_add_epi64(lanes, _mm256_set1_epi64x(1)), 32));
        const __m256 packed = _mm256_permutevar8x32_ps(_mm256_castpd_ps(values.raw), halves);
        _mm256_storeu_pd(out, _mm256_castps_pd(packed));
    }

    [[gnu::always_inline]] static Batch2 load_rows2(const double* packed, const std::int32_t* rows) {
        const auto two = [&](int low, int high) {
            const __m128d first = _mm_loadu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[low]));
            const __m128d second = _mm_loadu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[high]));
            return _mm256_insertf128_pd(_mm256_castpd128_pd256(first), second, 1);
        };
        const __m256d even = two(0, 2), odd = two(1, 3);
        return {{Batch::Raw(_mm256_unpacklo_pd(even, odd)), Batch::Raw(_mm256_unpackhi_pd(even, odd))}};
    }
    [[gnu::always_inline]] static void store_rows2(double* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        const __m256d even = _mm256_unpacklo_pd(values[0].raw, values[1].raw);
        const __m256d odd = _mm256_unpackhi_pd(values[0].raw, values[1].raw);
        const auto to = [&](int i) { return packed + 2 * static_cast<std::ptrdiff_t>(rows[i]); };
        _mm_storeu_pd(to(0), _mm256_castpd256_pd128(even));
        _mm_storeu_pd(to(1), _mm256_castpd256_pd128(odd));
        _mm_storeu_pd(to(2), _mm256_extractf128_pd(even, 1));
        _mm_storeu_pd(to(3), _mm256_extractf128_pd(odd, 1));
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const double* packed, const std::int32_t* rows) {
        const auto record = [&](int i) {
            return _mm256_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]));
        };
        return transposed(record(0), record(1), record(2), record(3));
    }
    static Batch4 load_differences4(const double* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto difference = [&](int i) {
            return _mm256_sub_pd(_mm256_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(of[i])),
                                 _mm256_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(from[i])));
        };
        return transposed(difference(0), difference(1), difference(2), difference(3));
    }
    [[gnu::always_inline]] static void store_rows4(double* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        const Batch4 records = transposed(values[0].raw, values[1].raw, values[2].raw, values[3].raw);
        for (int i = 0; i < 4; ++i)
            _mm256_storeu_pd(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]), records.lane[i].raw);
    }

    static Batch load_converted(const float* from) { return Batch::Raw(_mm256_cvtps_pd(_mm_loadu_ps(from))); }
    static Batch load_converted(const double* from) { return load_unaligned(from); }
    /// Toward minus infinity; |value| < 2^31.
    static Rows floor_to_rows(Batch value) { return _mm256_cvttpd_epi32(floor(value).raw); }
    static Batch floor(Batch value) { return Batch::Raw(_mm256_floor_pd(value.raw)); }

  private:
    [[gnu::always_inline]] static Batch4 transposed(__m256d a, __m256d b, __m256d c, __m256d d) {
        const __m256d ab_even = _mm256_unpacklo_pd(a, b), ab_odd = _mm256_unpackhi_pd(a, b);
        const __m256d cd_even = _mm256_unpacklo_pd(c, d), cd_odd = _mm256_unpackhi_pd(c, d);
        return {{Batch::Raw(_mm256_permute2f128_pd(ab_even, cd_even, 0x20)),
                 Batch::Raw(_mm256_permute2f128_pd(ab_odd, cd_odd, 0x20)),
                 Batch::Raw(_mm256_permute2f128_pd(ab_even, cd_even, 0x31)),
                 Batch::Raw(_mm256_permute2f128_pd(ab_odd, cd_odd, 0x31))}};
    }
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include "simd/batch.hpp"
#include "simd/scalar_lanes.hpp"

#include <emmintrin.h>

namespace carom::simd {
namespace {

inline unsigned bitmask(xsimd::batch_bool<float, xsimd::sse2> mask) {
    return static_cast<unsigned>(_mm_movemask_ps(mask));
}
inline unsigned bitmask(xsimd::batch_bool<double, xsimd::sse2> mask) {
    return static_cast<unsigned>(_mm_movemask_pd(mask));
}

template <>
struct Lanes<float, xsimd::sse2> : BatchLanes<float, xsimd::sse2> {
    using Rows = __m128i;

    static Rows broadcast_row(std::int32_t row) { return _mm_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) {
        return _mm_loadu_si128(reinterpret_cast<const __m128i*>(from));
    }
    static void store_rows(std::int32_t* to, Rows rows) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to), rows);
    }
    static Rows rows_sum(Rows a, Rows b) { return _mm_add_epi32(a, b); }

    static Rows rows_difference(Rows a, Rows b) { return _mm_sub_epi32(a, b); }
    static Rows rows_min(Rows a, Rows b) {
        const __m128i greater = _mm_cmpgt_epi32(a, b);
        return _mm_or_si128(_mm_and_si128(greater, b), _mm_andnot_si128(greater, a));
    }
    static constexpr auto store_marked_pairs = &store_marked_pairs_one_by_one;
    static void store_smallest4(std::int32_t* to, Rows a, Rows b, Rows c, Rows d) {
        const Rows ab = rows_min(_mm_unpacklo_epi32(a, b), _mm_unpackhi_epi32(a, b));
        const Rows cd = rows_min(_mm_unpacklo_epi32(c, d), _mm_unpackhi_epi32(c, d));
        store_rows(to, rows_min(_mm_unpacklo_epi64(ab, cd), _mm_unpackhi_epi64(ab, cd)));
    }

    static Batch gather_at(const float* column, const std::int32_t* rows) {
        return gather(column, load_rows(rows));
    }
    static Batch gather(const float* column, Rows rows) {
        alignas(16) std::int32_t row[size];
        _mm_store_si128(reinterpret_cast<__m128i*>(row), rows);
        return Batch::Raw(_mm_setr_ps(column[row[0]], column[row[1]], column[row[2]], column[row[3]]));
    }

    // SSE2 cannot permute by a register: four scalar stores, each advancing by its bit, have no branch.
    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        alignas(16) std::int32_t value[size];
        _mm_store_si128(reinterpret_cast<__m128i*>(value), values);
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < size; ++lane) {
            out[count] = value[lane];
            count += (bits >> lane) & 1u;
        }
        return count;
    }
    static void compress_store(float* out, Batch values, unsigned bits) {
        alignas(16) float value[size];
        _mm_store_ps(value, values.raw);
        std::size_t count = 0;
        for (std::size_t lane = 0; lane < size; ++lane) {
            out[count] = value[lane];
            count += (bits >> lane) & 1u;
        }
    }

    // Records are always inlined: left to itself gcc stops doing so once enough kernels use them, and a gas
    // takes 6 % more instructions (tools/count_instructions).
    [[gnu::always_inline]] static Batch2 load_rows2(const float* packed, const std::int32_t* rows) {
        const auto two = [&](int first, int second) {
            const __m128 low = load_pair(packed + 2 * static_cast<std::ptrdiff_t>(rows[first]));
            const __m128 high = load_pair(packed + 2 * static_cast<std::ptrdiff_t>(rows[second]));
            return _mm_movelh_ps(low, high);
        };
        const __m128 ab = two(0, 1), cd = two(2, 3);
        return {{Batch::Raw(_mm_shuffle_ps(ab, cd, _MM_SHUFFLE(2, 0, 2, 0))),
                 Batch::Raw(_mm_shuffle_ps(ab, cd, _MM_SHUFFLE(3, 1, 3, 1)))}};
    }
    [[gnu::always_inline]] static void store_rows2(float* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        const __m128 ab = _mm_unpacklo_ps(values[0].raw, values[1].raw);
        const __m128 cd = _mm_unpackhi_ps(values[0].raw, values[1].raw);
        const auto to = [&](int i) {
            return reinterpret_cast<__m64*>(packed + 2 * static_cast<std::ptrdiff_t>(rows[i]));
        };
        _mm_storel_pi(to(0), ab), _mm_storeh_pi(to(1), ab);
        _mm_storel_pi(to(2), cd), _mm_storeh_pi(to(3), cd);
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const float* packed, const std::int32_t* rows) {
        const auto record = [&](int i) {
            return _mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]));
        };
        return transposed(record(0), record(1), record(2), record(3));
    }
    static Batch4 load_differences4(const float* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto difference = [&](int i) {
            return _mm_sub_ps(_mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(of[i])),
                              _mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(from[i])));
        };
        return transposed(difference(0), difference(1), difference(2), difference(3));
    }
    [[gnu::always_inline]] static void store_rows4(float* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        __m128 r0 = values[0].raw, r1 = values[1].raw, r2 = values[2].raw, r3 = values[3].raw;
        _MM_TRANSPOSE4_PS(r0, r1, r2, r3);
        _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[0]), r0);
        _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[1]), r1);
        _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[2]), r2);
        _mm_storeu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[3]), r3);
    }

  private:
    [[gnu::always_inline]] static Batch4 transposed(__m128 a, __m128 b, __m128 c, __m128 d) {
        _MM_TRANSPOSE4_PS(a, b, c, d);
        return {{Batch::Raw(a), Batch::Raw(b), Batch::Raw(c), Batch::Raw(d)}};
    }
    static __m128 load_pair(const float* pair) {
        return _mm_castpd_ps(_mm_load_sd(reinterpret_cast<const double*>(pair)));
    }
};

template <>
struct Lanes<double, xsimd::sse2> : BatchLanes<double, xsimd::sse2> {
    using Rows = __m128i;  // two rows in the low half

    static Rows broadcast_row(std::int32_t row) { return _mm_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) {
        return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(from));
    }
    static void store_rows(std::int32_t* to, Rows rows) {
        _mm_storel_epi64(reinterpret_cast<__m128i*>(to), rows);
    }
    static Rows rows_sum(Rows a, Rows b) { return _mm_add_epi32(a, b); }

    static Batch gather_at(const double* column, const std::int32_t* rows) {
        return gather(column, load_rows(rows));
    }
    static Batch gather(const double* column, Rows rows) {
        const std::int32_t first = _mm_cvtsi128_si32(rows);
        const std::int32_t second = _mm_cvtsi128_si32(_mm_shuffle_epi32(rows, 1));
        return Batch::Raw(_mm_setr_pd(column[first], column[second]));
    }

    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        const std::size_t first = bits & 1u;
        out[0] = _mm_cvtsi128_si32(values);
        out[first] = _mm_cvtsi128_si32(_mm_shuffle_epi32(values, 1));
        return first + ((bits >> 1) & 1u);
    }
    static void compress_store(double* out, Batch values, unsigned bits) {
        _mm_store_sd(out, values.raw);
        _mm_storeh_pd(out + (bits & 1u), values.raw);
    }

    [[gnu::always_inline]] static Batch2 load_rows2(const double* packed, const std::int32_t* rows) {
        const __m128d a = _mm_loadu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[0]));
        const __m128d b = _mm_loadu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[1]));
        return {{Batch::Raw(_mm_unpacklo_pd(a, b)), Batch::Raw(_mm_unpackhi_pd(a, b))}};
    }
    [[gnu::always_inline]] static void store_rows2(double* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        _mm_storeu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[0]),
                      _mm_unpacklo_pd(values[0].raw, values[1].raw));
        _mm_storeu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[1]),
                      _mm_unpackhi_pd(values[0].raw, values[1].raw));
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const double* packed, const std::int32_t* rows) {
        const auto half = [&](int i, int first) {
            return _mm_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]) + first);
        };
        return transposed(half(0, 0), half(0, 2), half(1, 0), half(1, 2));
    }
    static Batch4 load_differences4(const double* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto half = [&](int i, int first) {
            return _mm_sub_pd(_mm_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(of[i]) + first),
                              _mm_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(from[i]) + first));
        };
        return transposed(half(0, 0), half(0, 2), half(1, 0), half(1, 2));
    }
    [[gnu::always_inline]] static void store_rows4(double* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        double* a = packed + 4 * static_cast<std::ptrdiff_t>(rows[0]);
        double* b = packed + 4 * static_cast<std::ptrdiff_t>(rows[1]);
        _mm_storeu_pd(a, _mm_unpacklo_pd(values[0].raw, values[1].raw));
        _mm_storeu_pd(a + 2, _mm_unpacklo_pd(values[2].raw, values[3].raw));
        _mm_storeu_pd(b, _mm_unpackhi_pd(values[0].raw, values[1].raw));
        _mm_storeu_pd(b + 2, _mm_unpackhi_pd(values[2].raw, values[3].raw));
    }

    static Batch load_converted(const float* from) {
        return Batch::Raw(
            _mm_cvtps_pd(_mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)))));
    }
    static Batch load_converted(const double* from) { return load_unaligned(from); }
    /// Toward minus infinity; |value| < 2^31.
    static Rows floor_to_rows(Batch value) { return _mm_cvttpd_epi32(floor(value).raw); }
    static Batch floor(Batch value) {
        const __m128d toward_zero = _mm_cvtepi32_pd(_mm_cvttpd_epi32(value.raw));
        const __m128d too_large = _mm_cmpgt_pd(toward_zero, value.raw);
        return Batch::Raw(_mm_sub_pd(toward_zero, _mm_and_pd(too_large, _mm_set1_pd(1.0))));
    }

  private:
    [[gnu::always_inline]] static Batch4 transposed(__m128d a01, __m128d a23, __m128d b01, __m128d b23) {
        return {{Batch::Raw(_mm_unpacklo_pd(a01, b01)), Batch::Raw(_mm_unpackhi_pd(a01, b01)),
                 Batch::Raw(_mm_unpacklo_pd(a23, b23)), Batch::Raw(_mm_unpackhi_pd(a23, b23))}};
    }
};

}  // namespace
}  // namespace carom::simd

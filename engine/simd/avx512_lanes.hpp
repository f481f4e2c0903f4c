#pragma once

#include "simd/avx2_lanes.hpp"
#include "simd/batch.hpp"

#include <immintrin.h>

namespace carom::simd {
namespace {

inline unsigned bitmask(xsimd::batch_bool<float, xsimd::avx512bw> mask) {
    return static_cast<__mmask16>(mask.data);
}
inline unsigned bitmask(xsimd::batch_bool<double, xsimd::avx512bw> mask) {
    return static_cast<__mmask8>(mask.data);
}

template <>
struct Lanes<float, xsimd::avx512bw> : BatchLanes<float, xsimd::avx512bw> {
    using Rows = __m512i;

    static Rows broadcast_row(std::int32_t row) { return _mm512_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) { return _mm512_loadu_si512(from); }
    static void store_rows(std::int32_t* to, Rows rows) { _mm512_storeu_si512(to, rows); }
    static Rows rows_sum(Rows a, Rows b) { return _mm512_add_epi32(a, b); }

    static Rows rows_difference(Rows a, Rows b) { return _mm512_sub_epi32(a, b); }
    static Rows rows_min(Rows a, Rows b) { return _mm512_min_epi32(a, b); }
    static void store_smallest4(std::int32_t* to, Rows a, Rows b, Rows c, Rows d) {
        const auto quad = [](Rows rows) {
            const __m256i eight =
                _mm256_min_epi32(_mm512_castsi512_si256(rows), _mm512_extracti64x4_epi64(rows, 1));
            return _mm_min_epi32(_mm256_castsi256_si128(eight), _mm256_extracti128_si256(eight, 1));
        };
        const __m128i qa = quad(a), qb = quad(b), qc = quad(c), qd = quad(d);
        const __m128i ab = _mm_min_epi32(_mm_unpacklo_epi32(qa, qb), _mm_unpackhi_epi32(qa, qb));
        const __m128i cd = _mm_min_epi32(_mm_unpacklo_epi32(qc, qd), _mm_unpackhi_epi32(qc, qd));
        const __m128i all = _mm_min_epi32(_mm_unpacklo_epi64(ab, cd), _mm_unpackhi_epi64(ab, cd));
        _mm_storeu_si128(reinterpret_cast<__m128i*>(to), all);
    }

    static Batch gather_at(const float* column, const std::int32_t* rows) {
        using Half = Lanes<float, xsimd::avx2>;
        const __m512 low = _mm512_castps256_ps512(Half::gather_at(column, rows).raw);
        return Batch::Raw(_mm512_insertf32x8(low, Half::gather_at(column, rows + 8).raw, 1));
    }
    static Batch gather(const float* column, Rows rows) {
        return Batch::Raw(_mm512_i32gather_ps(rows, column, sizeof(float)));
    }

    // In a register, then a full store: the form that compresses to memory is microcoded on Zen 4.
    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        store_rows(out, _mm512_maskz_compress_epi32(static_cast<__mmask16>(bits), values));
        return static_cast<std::size_t>(__builtin_popcount(bits));
    }

    // A store at any address is the dear part: four compressed registers are put one behind the other first.
    static std::size_t store_marked_pairs(std::int32_t* to_a, std::int32_t* to_b, const std::int32_t* a,
                                          const std::int32_t* b, std::uint64_t word) {
        const auto mask = [&](int j) { return static_cast<__mmask16>(word >> (16 * j)); };
        const auto before = [&](int j) {  // how many rows 0 ... j - 1 give
            return static_cast<unsigned>(__builtin_popcountll(word & ((std::uint64_t{1} << (16 * j)) - 1)));
        };
        const auto from_lane = [](unsigned lane) { return static_cast<__mmask16>(~0u << lane); };
        const auto rows_a = [&](int j) { return _mm512_maskz_compress_epi32(mask(j), load_rows(a)); };
        const auto rows_b = [&](int j) { return _mm512_maskz_compress_epi32(mask(j), load_rows(b + j)); };
        const auto total = static_cast<unsigned>(__builtin_popcountll(word));
        if (total <= size) {
            Rows all_a = rows_a(0), all_b = rows_b(0);
            for (int j = 1; j < 4; ++j) {
                all_a = _mm512_mask_expand_epi32(all_a, from_lane(before(j)), rows_a(j));
                all_b = _mm512_mask_expand_epi32(all_b, from_lane(before(j)), rows_b(j));
            }
            store_rows(to_a, all_a);
            store_rows(to_b, all_b);
        } else {
            for (int j = 0; j < 4; ++j) {
                store_rows(to_a + before(j), rows_a(j));
                store_rows(to_b + before(j), rows_b(j));
            }
        }
        return total;
    }
    static void compress_store(float* out, Batch values, unsigned bits) {
        _mm512_storeu_ps(out, _mm512_maskz_compress_ps(static_cast<__mmask16>(bits), values.raw));
    }

    // Records are always inlined: left to itself gcc stops doing so once enough kernels use them, and a gas
    // takes 6 % more instructions (tools/count_instructions).
    [[gnu::always_inline]] static Batch2 load_rows2(const float* packed, const std::int32_t* rows) {
        const auto low = Lanes<float, xsimd::avx2>::load_rows2(packed, rows);
        const auto high = Lanes<float, xsimd::avx2>::load_rows2(packed, rows + 8);
        return {{joined(low[0].raw, high[0].raw), joined(low[1].raw, high[1].raw)}};
    }
    [[gnu::always_inline]] static void store_rows2(float* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        using Half = Lanes<float, xsimd::avx2>;
        Half::store_rows2(packed, rows, {{low_half(values[0].raw), low_half(values[1].raw)}});
        Half::store_rows2(packed, rows + 8, {{high_half(values[0].raw), high_half(values[1].raw)}});
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const float* packed, const std::int32_t* rows) {
        return transposed(four_records(packed, rows, 0), four_records(packed, rows, 1),
                          four_records(packed, rows, 2), four_records(packed, rows, 3));
    }
    static Batch4 load_differences4(const float* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto difference = [&](int i) {
            return _mm512_sub_ps(four_records(packed, of, i), four_records(packed, from, i));
        };
        return transposed(difference(0), difference(1), difference(2), difference(3));
    }
    [[gnu::always_inline]] static void store_rows4(float* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        const Batch4 records = transposed(values[0].raw, values[1].raw, values[2].raw, values[3].raw);
        const auto to = [&](int i) { return packed + 4 * static_cast<std::ptrdiff_t>(rows[i]); };
        for (int i = 0; i < 4; ++i) _mm_storeu_ps(to(i), _mm512_castps512_ps128(records.lane[i].raw));
        for (int i = 0; i < 4; ++i) _mm_storeu_ps(to(i + 4), _mm512_extractf32x4_ps(records.lane[i].raw, 1));
        for (int i = 0; i < 4; ++i) _mm_storeu_ps(to(i + 8), _mm512_extractf32x4_ps(records.lane[i].raw, 2));
        for (int i = 0; i < 4; ++i) _mm_storeu_ps(to(i + 12), _mm512_extractf32x4_ps(records.lane[i].raw, 3));
    }

    // Rows that are consecutive by fours, of which only the first is read. Pairs: of each eight such records
    // those of a are the first, third, fifth and seventh, and those of b are between them.
    [[gnu::always_inline]] static Batch2 load_runs2(const float* packed, const std::int32_t* rows) {
        const auto eight = [&](int i) {
            const __m256 low = _mm256_loadu_ps(record2(packed, rows[i])),
                         high = _mm256_loadu_ps(record2(packed, rows[i + 4]));
            return _mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1);
        };
        const __m512 low = eight(0), high = eight(8);
        return {{Batch::Raw(_mm512_permutex2var_ps(low, every_second(0), high)),
                 Batch::Raw(_mm512_permutex2var_ps(low, every_second(1), high))}};
    }
    [[gnu::always_inline]] static void store_runs2(float* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        const auto store_eight = [&](int i, __m512i order) {
            const __m512 eight = _mm512_permutex2var_ps(values[0].raw, order, values[1].raw);
            _mm256_storeu_ps(record2(packed, rows[i]), _mm512_castps512_ps256(eight));
            _mm256_storeu_ps(record2(packed, rows[i + 4]), _mm512_extractf32x8_ps(eight, 1));
        };
        store_eight(0, turns_of(0)), store_eight(8, turns_of(8));
    }
    [[gnu::always_inline]] static Batch4 load_runs4(const float* packed, const std::int32_t* rows) {
        const auto four = [&](int i) { return _mm512_loadu_ps(record4(packed, rows[i])); };
        return fields_of(four(0), four(4), four(8), four(12));
    }
    [[gnu::always_inline]] static void store_runs4(float* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        const Batch4 fours = records_of(values);
        for (int i = 0; i < 4; ++i) _mm512_storeu_ps(record4(packed, rows[4 * i]), fours.lane[i].raw);
    }
    [[gnu::always_inline]] static void load_pairs2(const float* packed, const std::int32_t* rows, Batch2& a,
                                                   Batch2& b) {
        const auto four = [&](int i) { return _mm512_loadu_ps(record2(packed, rows[i])); };
        const Batch4 both = fields_of(four(0), four(4), four(8), four(12));
        a = {{both[0], both[1]}}, b = {{both[2], both[3]}};
    }
    [[gnu::always_inline]] static void store_pairs2(float* packed, const std::int32_t* rows, const Batch2& a,
                                                    const Batch2& b) {
        const Batch4 fours = records_of({{a[0], a[1], b[0], b[1]}});
        for (int i = 0; i < 4; ++i) _mm512_storeu_ps(record2(packed, rows[4 * i]), fours.lane[i].raw);
    }
    [[gnu::always_inline]] static void load_pairs4(const float* packed, const std::int32_t* rows, Batch4& a,
                                                   Batch4& b) {
        __m512 of_a[4], of_b[4];  // of four records each, a quarter a field
        for (int i = 0; i < 4; ++i) {
            const float* eight = record4(packed, rows[4 * i]);
            const __m512 low = _mm512_loadu_ps(eight), high = _mm512_loadu_ps(eight + 16);
            of_a[i] = _mm512_permutex2var_ps(low, fields_of_pairs(0), high);
            of_b[i] = _mm512_permutex2var_ps(low, fields_of_pairs(4), high);
        }
        a = quarters_transposed(of_a[0], of_a[1], of_a[2], of_a[3]);
        b = quarters_transposed(of_b[0], of_b[1], of_b[2], of_b[3]);
    }
    [[gnu::always_inline]] static void store_pairs4(float* packed, const std::int32_t* rows, const Batch4& a,
                                                    const Batch4& b) {
        const Batch4 of_a = quarters_transposed(a[0].raw, a[1].raw, a[2].raw, a[3].raw),
                     of_b = quarters_transposed(b[0].raw, b[1].raw, b[2].raw, b[3].raw);
        for (int i = 0; i < 4; ++i) {
            float* eight = record4(packed, rows[4 * i]);
            const __m512 p = of_a.lane[i].raw, q = of_b.lane[i].raw;
            _mm512_storeu_ps(eight, _mm512_permutex2var_ps(p, two_fields(0), q));
            _mm512_storeu_ps(eight + 16, _mm512_permutex2var_ps(p, two_fields(2), q));
        }
    }

  private:
    template <class Number>
    static Number* record2(Number* packed, std::int32_t row) {
        return packed + 2 * static_cast<std::ptrdiff_t>(row);
    }
    template <class Number>
    static Number* record4(Number* packed, std::int32_t row) {
        return packed + 4 * static_cast<std::ptrdiff_t>(row);
    }

    // The next four are orders for _mm512_permutex2var_ps, in which 0 ... 15 name the numbers of the first
    // operand and 16 ... 31 those of the second.
    /// This order takes every second number from k on.
    static __m512i every_second(int k) {
        return _mm512_setr_epi32(k, k + 2, k + 4, k + 6, k + 8, k + 10, k + 12, k + 14, k + 16, k + 18,
                                 k + 20, k + 22, k + 24, k + 26, k + 28, k + 30);
    }
    /// This order takes field k of each of eight records of four numbers, then field k + 1 of each.
    static __m512i two_fields(int k) {
        return _mm512_setr_epi32(k, k + 4, k + 8, k + 12, k + 16, k + 20, k + 24, k + 28, k + 1, k + 5, k + 9,
                                 k + 13, k + 17, k + 21, k + 25, k + 29);
    }
    /// This order takes numbers k ... k + 7 of both operands by turns.
    static __m512i turns_of(int k) {
        return _mm512_setr_epi32(k, k + 16, k + 1, k + 17, k + 2, k + 18, k + 3, k + 19, k + 4, k + 20, k + 5,
                                 k + 21, k + 6, k + 22, k + 7, k + 23);
    }
    /// This order takes, of four pairs of records, the four fields of each first (k = 0) or second (k = 4)
    /// one, field after field.
    static __m512i fields_of_pairs(int k) {
        return _mm512_setr_epi32(k, k + 8, k + 16, k + 24, k + 1, k + 9, k + 17, k + 25, k + 2, k + 10,
                                 k + 18, k + 26, k + 3, k + 11, k + 19, k + 27);
    }
    /// fields_of gives the four fields of 16 records that lie four in a register; records_of is its reverse.
    [[gnu::always_inline]] static Batch4 fields_of(__m512 a, __m512 b, __m512 c, __m512 d) {
        const __m512 ab01 = _mm512_permutex2var_ps(a, two_fields(0), b),
                     cd01 = _mm512_permutex2var_ps(c, two_fields(0), d),
                     ab23 = _mm512_permutex2var_ps(a, two_fields(2), b),
                     cd23 = _mm512_permutex2var_ps(c, two_fields(2), d);
        return {{Batch::Raw(_mm512_shuffle_f32x4(ab01, cd01, 0x44)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab01, cd01, 0xee)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab23, cd23, 0x44)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab23, cd23, 0xee))}};
    }
    [[gnu::always_inline]] static Batch4 records_of(const Batch4& fields) {
        const auto by_turns = [](const Batch& p, __m512i order, const Batch& q) {
            return _mm512_castps_pd(_mm512_permutex2var_ps(p.raw, order, q.raw));
        };
        const auto half = [](__m512d p, __m512i order, __m512d q) {
            return Batch::Raw(_mm512_castpd_ps(_mm512_permutex2var_pd(p, order, q)));
        };
        const __m512d p01 = by_turns(fields[0], turns_of(0), fields[1]),
                      p23 = by_turns(fields[2], turns_of(0), fields[3]),
                      q01 = by_turns(fields[0], turns_of(8), fields[1]),
                      q23 = by_turns(fields[2], turns_of(8), fields[3]);
        const __m512i first = _mm512_setr_epi64(0, 8, 1, 9, 2, 10, 3, 11),
                      second = _mm512_setr_epi64(4, 12, 5, 13, 6, 14, 7, 15);
        return {
            {half(p01, first, p23), half(p01, second, p23), half(q01, first, q23), half(q01, second, q23)}};
    }
    /// The quarters of 128 bits of four registers are transposed as a matrix of 4 x 4.
    [[gnu::always_inline]] static Batch4 quarters_transposed(__m512 a, __m512 b, __m512 c, __m512 d) {
        const __m512 ab_low = _mm512_shuffle_f32x4(a, b, 0x44), cd_low = _mm512_shuffle_f32x4(c, d, 0x44),
                     ab_high = _mm512_shuffle_f32x4(a, b, 0xee), cd_high = _mm512_shuffle_f32x4(c, d, 0xee);
        return {{Batch::Raw(_mm512_shuffle_f32x4(ab_low, cd_low, 0x88)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab_low, cd_low, 0xdd)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab_high, cd_high, 0x88)),
                 Batch::Raw(_mm512_shuffle_f32x4(ab_high, cd_high, 0xdd))}};
    }

    /// The records of rows i, i + 4, i + 8 and i + 12.
    static __m512 four_records(const float* packed, const std::int32_t* rows, int i) {
        const auto record = [&](int lane) {
            return _mm_loadu_ps(packed + 4 * static_cast<std::ptrdiff_t>(rows[lane]));
        };
        __m512 records = _mm512_castps128_ps512(record(i));
        records = _mm512_insertf32x4(records, record(i + 4), 1);
        records = _mm512_insertf32x4(records, record(i + 8), 2);
        return _mm512_insertf32x4(records, record(i + 12), 3);
    }

    using HalfBatch = Lanes<float, xsimd::avx2>::Batch;
    static Batch joined(__m256 low, __m256 high) {
        return Batch::Raw(_mm512_insertf32x8(_mm512_castps256_ps512(low), high, 1));
    }
    static HalfBatch low_half(__m512 values) { return HalfBatch::Raw(_mm512_castps512_ps256(values)); }
    static HalfBatch high_half(__m512 values) { return HalfBatch::Raw(_mm512_extractf32x8_ps(values, 1)); }

    /// 4 x 4 in each 128-bit quarter.
    [[gnu::always_inline]] static Batch4 transposed(__m512 a, __m512 b, __m512 c, __m512 d) {
        const __m512d ab_low = _mm512_castps_pd(_mm512_unpacklo_ps(a, b));
        const __m512d ab_high = _mm512_castps_pd(_mm512_unpackhi_ps(a, b));
        const __m512d cd_low = _mm512_castps_pd(_mm512_unpacklo_ps(c, d));
        const __m512d cd_high = _mm512_castps_pd(_mm512_unpackhi_ps(c, d));
        return {{Batch::Raw(_mm512_castpd_ps(_mm512_unpacklo_pd(ab_low, cd_low))),
                 Batch::Raw(_mm512_castpd_ps(_mm512_unpackhi_pd(ab_low, cd_low))),
                 Batch::Raw(_mm512_castpd_ps(_mm512_unpacklo_pd(ab_high, cd_high))),
                 Batch::Raw(_mm512_castpd_ps(_mm512_unpackhi_pd(ab_high, cd_high)))}};
    }
};

template <>
struct ShortLanes<float, xsimd::avx512bw> : Lanes<float, xsimd::avx2> {};

template <>
struct Lanes<double, xsimd::avx512bw> : BatchLanes<double, xsimd::avx512bw> {
    using Rows = __m256i;

    static Rows broadcast_row(std::int32_t row) { return _mm256_set1_epi32(row); }
    static Rows load_rows(const std::int32_t* from) {
        return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(from));
    }
    static void store_rows(std::int32_t* to, Rows rows) {
        _mm256_storeu_si256(reinterpret_cast<__m256i*>(to), rows);
    }
    static Rows rows_sum(Rows a, Rows b) { return _mm256_add_epi32(a, b); }

    static Batch gather_at(const double* column, const std::int32_t* rows) {
        using Half = Lanes<double, xsimd::avx2>;
        const __m512d low = _mm512_castpd256_pd512(Half::gather_at(column, rows).raw);
        return Batch::Raw(_mm512_insertf64x4(low, Half::gather_at(column, rows + 4).raw, 1));
    }
    static Batch gather(const double* column, Rows rows) {
        return Batch::Raw(_mm512_i32gather_pd(rows, column, sizeof(double)));
    }

    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        store_rows(out, _mm256_maskz_compress_epi32(static_cast<__mmask8>(bits), values));
        return static_cast<std::size_t>(__builtin_popcount(bits));
    }
    static void compress_store(double* out, Batch values, unsigned bits) {
        _mm512_storeu_pd(out, _mm512_maskz_compress_pd(static_cast<__mmask8>(bits), values.raw));
    }

    [[gnu::always_inline]] static Batch2 load_rows2(const double* packed, const std::int32_t* rows) {
        const auto four = [&](int i) {
            const auto record = [&](int k) {
                return _mm_loadu_pd(packed + 2 * static_cast<std::ptrdiff_t>(rows[k]));
            };
            __m512d records = _mm512_castpd128_pd512(record(i));
            records = _mm512_insertf64x2(records, record(i + 2), 1);
            records = _mm512_insertf64x2(records, record(i + 4), 2);
            return _mm512_insertf64x2(records, record(i + 6), 3);
        };
        const __m512d even = four(0), odd = four(1);
        return {{Batch::Raw(_mm512_unpacklo_pd(even, odd)), Batch::Raw(_mm512_unpackhi_pd(even, odd))}};
    }
    [[gnu::always_inline]] static void store_rows2(double* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        const __m512d even = _mm512_unpacklo_pd(values[0].raw, values[1].raw);
        const __m512d odd = _mm512_unpackhi_pd(values[0].raw, values[1].raw);
        const auto to = [&](int i) { return packed + 2 * static_cast<std::ptrdiff_t>(rows[i]); };
        _mm_storeu_pd(to(0), _mm512_castpd512_pd128(even));
        _mm_storeu_pd(to(1), _mm512_castpd512_pd128(odd));
        _mm_storeu_pd(to(2), _mm512_extractf64x2_pd(even, 1));
        _mm_storeu_pd(to(3), _mm512_extractf64x2_pd(odd, 1));
        _mm_storeu_pd(to(4), _mm512_extractf64x2_pd(even, 2));
        _mm_storeu_pd(to(5), _mm512_extractf64x2_pd(odd, 2));
        _mm_storeu_pd(to(6), _mm512_extractf64x2_pd(even, 3));
        _mm_storeu_pd(to(7), _mm512_extractf64x2_pd(odd, 3));
    }

    [[gnu::always_inline]] static Batch4 load_rows4(const double* packed, const std::int32_t* rows) {
        return transposed(two_records(packed, rows, 0), two_records(packed, rows, 1),
                          two_records(packed, rows, 2), two_records(packed, rows, 3));
    }
    static Batch4 load_differences4(const double* packed, const std::int32_t* of, const std::int32_t* from) {
        const auto difference = [&](int i) {
            return _mm512_sub_pd(two_records(packed, of, i), two_records(packed, from, i));
        };
        return transposed(difference(0), difference(1), difference(2), difference(3));
    }
    [[gnu::always_inline]] static void store_rows4(double* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        const Batch4 records = transposed(values[0].raw, values[1].raw, values[2].raw, values[3].raw);
        const auto to = [&](int i) { return packed + 4 * static_cast<std::ptrdiff_t>(rows[i]); };
        for (int i = 0; i < 4; ++i) _mm256_storeu_pd(to(i), _mm512_castpd512_pd256(records.lane[i].raw));
        for (int i = 0; i < 4; ++i)
            _mm256_storeu_pd(to(i + 4), _mm512_extractf64x4_pd(records.lane[i].raw, 1));
    }

    static Batch load_converted(const float* from) {
        return Batch::Raw(_mm512_cvtps_pd(_mm256_loadu_ps(from)));
    }
    static Batch load_converted(const double* from) { return load_unaligned(from); }
    /// Toward minus infinity; |value| < 2^31.
    static Rows floor_to_rows(Batch value) { return _mm512_cvttpd_epi32(floor(value).raw); }
    static Batch floor(Batch value) {
        return Batch::Raw(_mm512_roundscale_pd(value.raw, _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
    }

  private:
    /// The records of rows i and i + 4.
    static __m512d two_records(const double* packed, const std::int32_t* rows, int i) {
        const __m256d low = _mm256_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(rows[i]));
        const __m256d high = _mm256_loadu_pd(packed + 4 * static_cast<std::ptrdiff_t>(rows[i + 4]));
        return _mm512_insertf64x4(_mm512_castpd256_pd512(low), high, 1);
    }
    /// 4 x 4 in each 256-bit half.
    [[gnu::always_inline]] static Batch4 transposed(__m512d a, __m512d b, __m512d c, __m512d d) {
        const __m512d ab_even = _mm512_unpacklo_pd(a, b), ab_odd = _mm512_unpackhi_pd(a, b);
        const __m512d cd_even = _mm512_unpacklo_pd(c, d), cd_odd = _mm512_unpackhi_pd(c, d);
        const __m512i low = _mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13);
        const __m512i high = _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15);
        return {{Batch::Raw(_mm512_permutex2var_pd(ab_even, low, cd_even)),
                 Batch::Raw(_mm512_permutex2var_pd(ab_odd, low, cd_odd)),
                 Batch::Raw(_mm512_permutex2var_pd(ab_even, high, cd_even)),
                 Batch::Raw(_mm512_permutex2var_pd(ab_odd, high, cd_odd))}};
    }
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

/// Operations on row numbers, of the float lanes only.
struct RowProbe {
    void (*rows)(const std::int32_t* a, const std::int32_t* b, std::size_t count, std::int32_t* difference,
                 std::int32_t* min);
    void (*smallest4)(const std::int32_t* rows, std::int32_t* out);  // of four batches in a row
    std::size_t (*marked_pairs)(std::int32_t* to_a, std::int32_t* to_b, const std::int32_t* a,
                                const std::int32_t* b, std::uint64_t word);
};

/// Every lane operation over arrays, compiled once an instruction set by lanes_on_<isa>.cpp.
/// Arrays are 64-byte aligned and hold a multiple of 16 numbers; `count` is one.
template <class Real>
struct LaneProbe {
    std::size_t lanes;
    void (*arithmetic)(const Real* a, const Real* b, std::size_t count,
                       Real* out);  // out[kArithmetic][count]
    void (*comparisons)(const Real* a, const Real* b, std::size_t count,
                        unsigned* out);  // [kComparisons][lanes groups]
    void (*unaligned_copy)(const Real* from, std::size_t count, Real* to);
    void (*gather)(const Real* column, const std::int32_t* rows, std::size_t count, Real* out);
    void (*gather_at)(const Real* column, const std::int32_t* rows, std::size_t count, Real* out);
    std::size_t (*compress)(const std::int32_t* values, unsigned bits, std::int32_t* out);  // one batch
    void (*compress_reals)(const Real* values, unsigned bits, Real* out);                   // one batch
    void (*rows2)(const Real* packed, const std::int32_t* rows, std::size_t count, Real* out,
                  Real* packed_out);  // out[2][count], and scattered back to packed_out
    void (*rows4)(const Real* packed, const std::int32_t* rows, std::size_t count, Real* out,
                  Real* packed_out);  // out[4][count], and scattered back to packed_out
    // Both fetch rows that lie in order (ordered_lanes.hpp) and put them back to packed2_out and packed4_out:
    // out[12][count] has the fields of both records of rows a, then those of rows b. `pairs` does nothing and
    // returns false where the instruction set has no such lanes.
    bool (*runs)(const Real* packed2, const Real* packed4, const std::int32_t* a, const std::int32_t* b,
                 std::size_t count, Real* out, Real* packed2_out, Real* packed4_out);
    bool (*pairs)(const Real* packed2, const Real* packed4, const std::int32_t* a, const std::int32_t* b,
                  std::size_t count, Real* out, Real* packed2_out, Real* packed4_out);
    void (*differences4)(const Real* packed, const std::int32_t* of, const std::int32_t* from,
                         std::size_t count, Real* out);  // out[4][count]
    void (*row_sums)(const std::int32_t* a, const std::int32_t* b, std::size_t count, std::int32_t* sums);
    void (*floor)(const float* values, std::size_t count, double* floors, std::int32_t* rows);
};

inline constexpr std::size_t kArithmetic = 14;
inline constexpr std::size_t kComparisons = 10;

struct LaneProbes {
    std::string_view isa;
    LaneProbe<float> single_precision;
    LaneProbe<double> double_precision;
    RowProbe rows;
};

#pragma once

#include <cstddef>
#include <cstdint>

namespace carom::simd {

/// The instruction set of plain C++: batches of one lane, so the scalar table has the same kernel text.
struct Scalar {};

namespace {

/// The lanes of one instruction set for one precision; what they offer is listed in lanes.hpp.
template <class Real, class Isa>
struct Lanes;

/// The lanes for a few numbers at a time: at most eight, where the instruction set has a choice.
template <class Real, class Isa>
struct ShortLanes : Lanes<Real, Isa> {};

// Built-ins, not std::sqrt: an inline function of the library could be emitted out of line as a weak symbol.
inline float sqrt(float value) {
    return __builtin_sqrtf(value);
}
inline double sqrt(double value) {
    return __builtin_sqrt(value);
}
inline float abs(float value) {
    return __builtin_fabsf(value);
}
inline double abs(double value) {
    return __builtin_fabs(value);
}
// These give what MINPS and MAXPS give: the second operand if either is NaN or both are zeros.
inline float min(float a, float b) {
    return a < b ? a : b;
}
inline double min(double a, double b) {
    return a < b ? a : b;
}
inline float max(float a, float b) {
    return a > b ? a : b;
}
inline double max(double a, double b) {
    return a > b ? a : b;
}
// The power of two at or below |value|, with its sign; 0 below the normal numbers, infinite for NaN.
inline float binade(float value) {
    return __builtin_bit_cast(float, __builtin_bit_cast(std::uint32_t, value) & 0xff800000u);
}
inline double binade(double value) {
    return __builtin_bit_cast(double, __builtin_bit_cast(std::uint64_t, value) & 0xfff0000000000000u);
}
inline float select(bool mask, float if_true, float if_false) {
    return mask ? if_true : if_false;
}
inline double select(bool mask, double if_true, double if_false) {
    return mask ? if_true : if_false;
}
inline bool any(bool mask) {
    return mask;
}
inline bool all(bool mask) {
    return mask;
}
inline unsigned bitmask(bool mask) {
    return mask ? 1u : 0u;
}

/// For each set bit 16 j + i of the word, in order: a[i] to to_a, b[i + j] to to_b; returns how many. Instead
/// of a branch a pair, one for each so many as there seldom are: to_a and to_b need room for 64 + 7 pairs.
inline std::size_t store_marked_pairs_one_by_one(std::int32_t* to_a, std::int32_t* to_b,
                                                 const std::int32_t* a, const std::int32_t* b,
                                                 std::uint64_t word) {
    constexpr int kPairsAtOnce = 8;
    const auto total = static_cast<std::size_t>(__builtin_popcountll(word));
    std::size_t written = 0;
    do {
        for (int pair = 0; pair < kPairsAtOnce; ++pair) {
            const auto bit = static_cast<std::size_t>(__builtin_ctzll(word | (std::uint64_t{1} << 63)));
            to_a[written] = a[bit % 16];
            to_b[written] = b[bit % 16 + bit / 16];
            ++written;
            word &= word - 1;
        }
    } while (written < total);
    return total;
}

template <class Real>
struct ScalarLanes {
    static constexpr std::size_t size = 1;
    using Number = Real;
    using Batch = Real;
    using Mask = bool;
    using Rows = std::int32_t;

    struct Batch4 {
        Batch lane[4];
        Batch& operator[](std::size_t k) { return lane[k]; }
        const Batch& operator[](std::size_t k) const { return lane[k]; }
    };
    struct Batch2 {
        Batch lane[2];
        Batch& operator[](std::size_t k) { return lane[k]; }
        const Batch& operator[](std::size_t k) const { return lane[k]; }
    };

    static Batch broadcast(Real value) { return value; }
    static Batch load(const Real* from) { return *from; }
    static Batch load_unaligned(const Real* from) { return *from; }
    static void store(Real* to, Batch value) { *to = value; }
    static void store_unaligned(Real* to, Batch value) { *to = value; }
    static void scatter_at(Real* column, const std::int32_t* rows, Batch value) { column[*rows] = value; }

    static Rows broadcast_row(std::int32_t row) { return row; }
    static Rows load_rows(const std::int32_t* from) { return *from; }
    static void store_rows(std::int32_t* to, Rows rows) { *to = rows; }
    static Rows rows_sum(Rows a, Rows b) { return a + b; }

    static Batch gather(const Real* column, Rows rows) { return column[rows]; }
    static Batch gather_at(const Real* column, const std::int32_t* rows) { return column[*rows]; }

    static std::size_t compress_store(std::int32_t* out, Rows values, unsigned bits) {
        *out = values;
        return bits;
    }
    static void compress_store(Real* out, Batch values, unsigned) { *out = values; }

    static Batch4 load_rows4(const Real* packed, const std::int32_t* rows) {
        const Real* record = packed + 4 * static_cast<std::ptrdiff_t>(*rows);
        return {{record[0], record[1], record[2], record[3]}};
    }
    static Batch4 load_differences4(const Real* packed, const std::int32_t* of, const std::int32_t* from) {
        const Real* a = packed + 4 * static_cast<std::ptrdiff_t>(*from);
        const Real* b = packed + 4 * static_cast<std::ptrdiff_t>(*of);
        return {{b[0] - a[0], b[1] - a[1], b[2] - a[2], b[3] - a[3]}};
    }
    static void store_rows4(Real* packed, const std::int32_t* rows, const Batch4& values) {
        Real* record = packed + 4 * static_cast<std::ptrdiff_t>(*rows);
        for (int k = 0; k < 4; ++k) record[k] = values.lane[k];
    }
    static Batch2 load_rows2(const Real* packed, const std::int32_t* rows) {
        const Real* record = packed + 2 * static_cast<std::ptrdiff_t>(*rows);
        return {{record[0], record[1]}};
    }
    static void store_rows2(Real* packed, const std::int32_t* rows, const Batch2& values) {
        Real* record = packed + 2 * static_cast<std::ptrdiff_t>(*rows);
        record[0] = values.lane[0], record[1] = values.lane[1];
    }
};

template <>
struct Lanes<float, Scalar> : ScalarLanes<float> {
    static Rows rows_difference(Rows a, Rows b) { return a - b; }
    static Rows rows_min(Rows a, Rows b) { return a < b ? a : b; }
    static void store_smallest4(std::int32_t* to, Rows a, Rows b, Rows c, Rows d) {
        to[0] = a, to[1] = b, to[2] = c, to[3] = d;
    }
    static constexpr auto store_marked_pairs = &store_marked_pairs_one_by_one;
};

template <>
struct Lanes<double, Scalar> : ScalarLanes<double> {
    static Batch load_converted(const float* from) { return static_cast<double>(*from); }
    static Batch load_converted(const double* from) { return *from; }
    /// Toward minus infinity; |value| < 2^31.
    static Rows floor_to_rows(Batch value) {
        const auto toward_zero = static_cast<std::int32_t>(value);
        return toward_zero - (static_cast<double>(toward_zero) > value ? 1 : 0);
    }
    static Batch floor(Batch value) { return static_cast<double>(floor_to_rows(value)); }
};

}  // namespace

}  // namespace carom::simd

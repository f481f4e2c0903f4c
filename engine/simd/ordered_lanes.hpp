#pragma once

#include <cstddef>
#include <cstdint>

// Lanes for batches whose rows lie in memory by fours, in the order of the lanes: records come and go by
// whole registers where the instruction set can sort them (avx512_lanes.hpp), for most of what a kernel of
// joints does is to fetch what it joins. Other instruction sets take rows as any others.

namespace carom::simd {
namespace {

/// Each four rows are consecutive; those of one operand have nothing to do with those of another.
template <class Base>
struct LanesOfRuns : Base {};

template <class Base>
requires requires {
    &Base::load_runs4;
}
struct LanesOfRuns<Base> : Base {
    using Number = typename Base::Number;
    using Batch2 = typename Base::Batch2;
    using Batch4 = typename Base::Batch4;

    [[gnu::always_inline]] static Batch2 load_rows2(const Number* packed, const std::int32_t* rows) {
        return Base::load_runs2(packed, rows);
    }
    [[gnu::always_inline]] static Batch4 load_rows4(const Number* packed, const std::int32_t* rows) {
        return Base::load_runs4(packed, rows);
    }
    [[gnu::always_inline]] static void store_rows2(Number* to, const std::int32_t* rows,
                                                   const Batch2& values) {
        Base::store_runs2(to, rows, values);
    }
    [[gnu::always_inline]] static void store_rows4(Number* to, const std::int32_t* rows,
                                                   const Batch4& values) {
        Base::store_runs4(to, rows, values);
    }
};

/// Lanes that load and store the rows of two operands at once: of each eight consecutive rows, the first,
/// third, fifth and seventh are of the one, those between of the other. Only where `Base` has load_pairs4.
template <class Base>
struct LanesOfPairs : Base {
    static constexpr bool kPairs = true;
};

/// Loads the records of two operands, however their rows lie.
template <class Lanes>
[[gnu::always_inline]] inline void load_both2(const typename Lanes::Number* packed,
                                              const std::int32_t* rows_a, const std::int32_t* rows_b,
                                              typename Lanes::Batch2& a, typename Lanes::Batch2& b) {
    if constexpr (requires { Lanes::kPairs; })
        Lanes::load_pairs2(packed, rows_a, a, b);
    else
        a = Lanes::load_rows2(packed, rows_a), b = Lanes::load_rows2(packed, rows_b);
}
template <class Lanes>
[[gnu::always_inline]] inline void load_both4(const typename Lanes::Number* packed,
                                              const std::int32_t* rows_a, const std::int32_t* rows_b,
                                              typename Lanes::Batch4& a, typename Lanes::Batch4& b) {
    if constexpr (requires { Lanes::kPairs; })
        Lanes::load_pairs4(packed, rows_a, a, b);
    else
        a = Lanes::load_rows4(packed, rows_a), b = Lanes::load_rows4(packed, rows_b);
}
template <class Lanes>
[[gnu::always_inline]] inline void store_both2(typename Lanes::Number* to, const std::int32_t* rows_a,
                                               const std::int32_t* rows_b, const typename Lanes::Batch2& a,
                                               const typename Lanes::Batch2& b) {
    if constexpr (requires { Lanes::kPairs; })
        Lanes::store_pairs2(to, rows_a, a, b);
    else
        Lanes::store_rows2(to, rows_a, a), Lanes::store_rows2(to, rows_b, b);
}
template <class Lanes>
[[gnu::always_inline]] inline void store_both4(typename Lanes::Number* to, const std::int32_t* rows_a,
                                               const std::int32_t* rows_b, const typename Lanes::Batch4& a,
                                               const typename Lanes::Batch4& b) {
    if constexpr (requires { Lanes::kPairs; })
        Lanes::store_pairs4(to, rows_a, a, b);
    else
        Lanes::store_rows4(to, rows_a, a), Lanes::store_rows4(to, rows_b, b);
}

}  // namespace
}  // namespace carom::simd

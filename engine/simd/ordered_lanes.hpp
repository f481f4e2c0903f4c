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
struct LanesOfRuns : Base {
    using Number = typename Base::Number;
    using Batch2 = typename Base::Batch2;
    using Batch4 = typename Base::Batch4;

    [[gnu::always_inline]] static Batch2 load_rows2(const Number* packed, const std::int32_t* rows) {
        if constexpr (requires { Base::load_runs2(packed, rows); })
            return Base::load_runs2(packed, rows);
        else
            return Base::load_rows2(packed, rows);
    }
    [[gnu::always_inline]] static void store_rows2(Number* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        if constexpr (requires { Base::load_runs2(packed, rows); })
            Base::store_runs2(packed, rows, values);
        else
            Base::store_rows2(packed, rows, values);
    }
    [[gnu::always_inline]] static Batch4 load_rows4(const Number* packed, const std::int32_t* rows) {
        if constexpr (requires { Base::load_runs4(packed, rows); })
            return Base::load_runs4(packed, rows);
        else
            return Base::load_rows4(packed, rows);
    }
    [[gnu::always_inline]] static void store_rows4(Number* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        if constexpr (requires { Base::load_runs4(packed, rows); })
            Base::store_runs4(packed, rows, values);
        else
            Base::store_rows4(packed, rows, values);
    }
};

/// Lanes that load and store the rows of two operands at once: of each eight consecutive rows, the first,
/// third, fifth and seventh are of the one, those between of the other. Only where `Base` has load_pairs4.
template <class Base>
struct LanesOfPairs : Base {
    static constexpr bool kPairs = true;
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include <cstddef>
#include <cstdint>

namespace carom::simd {
namespace {

/// Lanes for records that lie apart by their numbers, each of them a batch: all lanes are in the same row,
/// [rows][numbers of a record][lanes]. So a kernel over rows that lie anywhere runs over copies of them, from
/// which it loads and to which it stores whole batches.
template <class Base>
struct LanesOfBundle : Base {
    using Number = typename Base::Number;
    using Batch = typename Base::Batch;
    using Batch2 = typename Base::Batch2;
    using Batch4 = typename Base::Batch4;

    /// Place of a record of so many numbers.
    [[gnu::always_inline]] static std::size_t place_of(const std::int32_t* rows, std::size_t numbers) {
        return numbers * Base::size * static_cast<std::size_t>(*rows);
    }
    [[gnu::always_inline]] static Batch gather_at(const Number* column, const std::int32_t* rows) {
        return Base::load(column + place_of(rows, 1));
    }
    [[gnu::always_inline]] static void add_at(Number* column, const std::int32_t* rows, Batch more) {
        Number* const at = column + place_of(rows, 1);
        Base::store(at, Base::load(at) + more);
    }
    [[gnu::always_inline]] static Batch2 load_rows2(const Number* packed, const std::int32_t* rows) {
        const Number* const from = packed + place_of(rows, 2);
        return {{Base::load(from), Base::load(from + Base::size)}};
    }
    [[gnu::always_inline]] static void store_rows2(Number* packed, const std::int32_t* rows,
                                                   const Batch2& values) {
        Number* const to = packed + place_of(rows, 2);
        for (std::size_t i = 0; i < 2; ++i) Base::store(to + i * Base::size, values[i]);
    }
    [[gnu::always_inline]] static Batch4 load_rows4(const Number* packed, const std::int32_t* rows) {
        const Number* const from = packed + place_of(rows, 4);
        return {{Base::load(from), Base::load(from + Base::size), Base::load(from + 2 * Base::size),
                 Base::load(from + 3 * Base::size)}};
    }
    [[gnu::always_inline]] static void store_rows4(Number* packed, const std::int32_t* rows,
                                                   const Batch4& values) {
        Number* const to = packed + place_of(rows, 4);
        for (std::size_t i = 0; i < 4; ++i) Base::store(to + i * Base::size, values[i]);
    }
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include "lane_probe.hpp"
#include "simd/lanes.hpp"
#include "simd/ordered_lanes.hpp"

namespace {

namespace simd = carom::simd;

template <class Real, class Isa>
void probe_arithmetic(const Real* a, const Real* b, std::size_t count, Real* out) {
    using L = simd::Lanes<Real, Isa>;
    using Batch = typename L::Batch;
    for (std::size_t i = 0; i < count; i += L::size) {
        const Batch x = L::load(a + i), y = L::load(b + i);
        Batch sum = x, difference = x, product = x;
        sum += y;
        difference -= y;
        product *= y;
        const Batch results[kArithmetic] = {x + y,
                                            x - y,
                                            x * y,
                                            x / y,
                                            -x,
                                            simd::sqrt(simd::abs(x)),
                                            simd::abs(x),
                                            simd::binade(x),
                                            simd::min(x, y),
                                            simd::max(x, y),
                                            simd::select(x < y, x, L::broadcast(Real{7})),
                                            sum,
                                            difference,
                                            product};
        for (std::size_t k = 0; k < kArithmetic; ++k) L::store(out + k * count + i, results[k]);
    }
}

template <class Real, class Isa>
void probe_comparisons(const Real* a, const Real* b, std::size_t count, unsigned* out) {
    using L = simd::Lanes<Real, Isa>;
    using Batch = typename L::Batch;
    const auto bit = [](bool value) { return value ? 1u : 0u; };
    for (std::size_t i = 0; i < count; i += L::size) {
        const Batch x = L::load(a + i), y = L::load(b + i);
        const typename L::Mask less = x < y, equal = x == y;
        const unsigned results[kComparisons] = {simd::bitmask(less),         simd::bitmask(x <= y),
                                                simd::bitmask(x > y),        simd::bitmask(x >= y),
                                                simd::bitmask(equal),        simd::bitmask(!less),
                                                simd::bitmask(less | equal), simd::bitmask(less & equal),
                                                bit(simd::any(less)),        bit(simd::all(less))};
        for (std::size_t k = 0; k < kComparisons; ++k) *out++ = results[k];
    }
}

template <class Real, class Isa>
void probe_unaligned_copy(const Real* from, std::size_t count, Real* to) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) L::store_unaligned(to + i, L::load_unaligned(from + i));
}

template <class Real, class Isa>
void probe_gather(const Real* column, const std::int32_t* rows, std::size_t count, Real* out) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size)
        L::store(out + i, L::gather(column, L::load_rows(rows + i)));
}

template <class Real, class Isa>
void probe_gather_at(const Real* column, const std::int32_t* rows, std::size_t count, Real* out) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) L::store(out + i, L::gather_at(column, rows + i));
}

template <class Real, class Isa>
std::size_t probe_compress(const std::int32_t* values, unsigned bits, std::int32_t* out) {
    using L = simd::Lanes<Real, Isa>;
    L::store_rows(out, L::broadcast_row(-1));
    return L::compress_store(out, L::load_rows(values), bits);
}

template <class Real, class Isa>
void probe_compress_reals(const Real* values, unsigned bits, Real* out) {
    using L = simd::Lanes<Real, Isa>;
    L::compress_store(out, L::load(values), bits);
}

template <class Real, class Isa>
void probe_rows2(const Real* packed, const std::int32_t* rows, std::size_t count, Real* out,
                 Real* packed_out) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) {
        const typename L::Batch2 two = L::load_rows2(packed, rows + i);
        for (std::size_t k = 0; k < 2; ++k) L::store(out + k * count + i, two[k]);
        L::store_rows2(packed_out, rows + i, two);
    }
}

template <class Real, class Isa>
void probe_rows4(const Real* packed, const std::int32_t* rows, std::size_t count, Real* out,
                 Real* packed_out) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) {
        const typename L::Batch4 four = L::load_rows4(packed, rows + i);
        for (std::size_t k = 0; k < 4; ++k) L::store(out + k * count + i, four[k]);
        L::store_rows4(packed_out, rows + i, four);
    }
}

template <class L, class Real>
void probe_ordered_batch(const Real* packed2, const Real* packed4, const std::int32_t* a,
                         const std::int32_t* b, std::size_t i, std::size_t count, Real* out,
                         Real* packed2_out, Real* packed4_out) {
    typename L::Batch2 two_a, two_b;
    typename L::Batch4 four_a, four_b;
    simd::load_both2<L>(packed2, a + i, b + i, two_a, two_b);
    simd::load_both4<L>(packed4, a + i, b + i, four_a, four_b);
    simd::store_both2<L>(packed2_out, a + i, b + i, two_a, two_b);
    simd::store_both4<L>(packed4_out, a + i, b + i, four_a, four_b);
    for (std::size_t k = 0; k < 2; ++k) {
        L::store(out + k * count + i, two_a[k]);
        L::store(out + (6 + k) * count + i, two_b[k]);
    }
    for (std::size_t k = 0; k < 4; ++k) {
        L::store(out + (2 + k) * count + i, four_a[k]);
        L::store(out + (8 + k) * count + i, four_b[k]);
    }
}

template <class Real, class Isa>
bool probe_runs(const Real* packed2, const Real* packed4, const std::int32_t* a, const std::int32_t* b,
                std::size_t count, Real* out, Real* packed2_out, Real* packed4_out) {
    using L = simd::LanesOfRuns<simd::Lanes<Real, Isa>>;
    for (std::size_t i = 0; i < count; i += L::size)
        probe_ordered_batch<L>(packed2, packed4, a, b, i, count, out, packed2_out, packed4_out);
    return true;
}

template <class Real, class Isa>
bool probe_pairs([[maybe_unused]] const Real* packed2, [[maybe_unused]] const Real* packed4,
                 [[maybe_unused]] const std::int32_t* a, [[maybe_unused]] const std::int32_t* b,
                 [[maybe_unused]] std::size_t count, [[maybe_unused]] Real* out,
                 [[maybe_unused]] Real* packed2_out, [[maybe_unused]] Real* packed4_out) {
    using Base = simd::Lanes<Real, Isa>;
    if constexpr (requires { &Base::load_pairs4; }) {
        using L = simd::LanesOfPairs<Base>;
        for (std::size_t i = 0; i < count; i += L::size)
            probe_ordered_batch<L>(packed2, packed4, a, b, i, count, out, packed2_out, packed4_out);
        return true;
    } else {
        return false;
    }
}

template <class Real, class Isa>
void probe_differences4(const Real* packed, const std::int32_t* of, const std::int32_t* from,
                        std::size_t count, Real* out) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) {
        const typename L::Batch4 four = L::load_differences4(packed, of + i, from + i);
        for (std::size_t k = 0; k < 4; ++k) L::store(out + k * count + i, four[k]);
    }
}

template <class Real, class Isa>
void probe_row_sums(const std::int32_t* a, const std::int32_t* b, std::size_t count, std::int32_t* sums) {
    using L = simd::Lanes<Real, Isa>;
    for (std::size_t i = 0; i < count; i += L::size)
        L::store_rows(sums + i, L::rows_sum(L::load_rows(a + i), L::load_rows(b + i)));
}

template <class Isa>
void probe_floor(const float* values, std::size_t count, double* floors, std::int32_t* rows) {
    using L = simd::Lanes<double, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) {
        const typename L::Batch value = L::load_converted(values + i);
        L::store(floors + i, L::floor(value));
        L::store_rows(rows + i, L::floor_to_rows(value));
    }
}

template <class Isa>
void probe_rows(const std::int32_t* a, const std::int32_t* b, std::size_t count, std::int32_t* difference,
                std::int32_t* min) {
    using L = simd::Lanes<float, Isa>;
    for (std::size_t i = 0; i < count; i += L::size) {
        const auto x = L::load_rows(a + i), y = L::load_rows(b + i);
        L::store_rows(difference + i, L::rows_difference(x, y));
        L::store_rows(min + i, L::rows_min(x, y));
    }
}

template <class Isa>
void probe_smallest4(const std::int32_t* rows, std::int32_t* out) {
    using L = simd::Lanes<float, Isa>;
    const auto batch = [&](std::size_t k) { return L::load_rows(rows + k * L::size); };
    L::store_smallest4(out, batch(0), batch(1), batch(2), batch(3));
}

template <class Isa>
std::size_t probe_marked_pairs(std::int32_t* to_a, std::int32_t* to_b, const std::int32_t* a,
                               const std::int32_t* b, std::uint64_t word) {
    return simd::Lanes<float, Isa>::store_marked_pairs(to_a, to_b, a, b, word);
}

template <class Real, class Isa>
constexpr LaneProbe<Real> make_lane_probe() {
    return {simd::Lanes<Real, Isa>::size,     &probe_arithmetic<Real, Isa>,     &probe_comparisons<Real, Isa>,
            &probe_unaligned_copy<Real, Isa>, &probe_gather<Real, Isa>,         &probe_gather_at<Real, Isa>,
            &probe_compress<Real, Isa>,       &probe_compress_reals<Real, Isa>, &probe_rows2<Real, Isa>,
            &probe_rows4<Real, Isa>,          &probe_runs<Real, Isa>,           &probe_pairs<Real, Isa>,
            &probe_differences4<Real, Isa>,   &probe_row_sums<Real, Isa>,       &probe_floor<Isa>};
}

template <class Isa>
constexpr LaneProbes make_lane_probes(std::string_view isa) {
    return {isa,
            make_lane_probe<float, Isa>(),
            make_lane_probe<double, Isa>(),
            {&probe_rows<Isa>, &probe_smallest4<Isa>, &probe_marked_pairs<Isa>}};
}

}  // namespace

#pragma once

#include <xsimd/xsimd.hpp>

#include <cstddef>
#include <cstdint>

namespace carom::simd {
namespace {

/// A register of Real. A thin dress over xsimd::batch with internal linkage, so that formulas written for a
/// float read the same over lanes, and with the operations that xsimd 8.1 gets wrong put right: its unary
/// minus turns 0 into +0 on AVX-512 only.
template <class Real, class Isa>
struct Batch {
    using Raw = xsimd::batch<Real, Isa>;
    using Mask = xsimd::batch_bool<Real, Isa>;

    Raw raw;

    Batch() = default;
    explicit Batch(Real value) : raw(value) {}
    Batch(Raw value) : raw(value) {}

    friend Batch operator+(Batch a, Batch b) { return a.raw + b.raw; }
    friend Batch operator-(Batch a, Batch b) { return a.raw - b.raw; }
    friend Batch operator*(Batch a, Batch b) { return a.raw * b.raw; }
    friend Batch operator/(Batch a, Batch b) { return a.raw / b.raw; }
    friend Batch operator-(Batch a) { return a.raw ^ Raw(Real{-0.0}); }
    Batch& operator+=(Batch b) { return *this = *this + b; }
    Batch& operator-=(Batch b) { return *this = *this - b; }
    Batch& operator*=(Batch b) { return *this = *this * b; }

    friend Mask operator<(Batch a, Batch b) { return a.raw < b.raw; }
    friend Mask operator<=(Batch a, Batch b) { return a.raw <= b.raw; }
    friend Mask operator>(Batch a, Batch b) { return a.raw > b.raw; }
    friend Mask operator>=(Batch a, Batch b) { return a.raw >= b.raw; }
    friend Mask operator==(Batch a, Batch b) { return a.raw == b.raw; }
};

// Free functions as for scalars (scalar_lanes.hpp), so that `simd::sqrt(x)` serves both.
template <class Real, class Isa>
Batch<Real, Isa> sqrt(Batch<Real, Isa> a) {
    return xsimd::sqrt(a.raw);
}
template <class Real, class Isa>
Batch<Real, Isa> abs(Batch<Real, Isa> a) {
    return xsimd::abs(a.raw);
}
template <class Real, class Isa>
Batch<Real, Isa> min(Batch<Real, Isa> a, Batch<Real, Isa> b) {
    return xsimd::min(a.raw, b.raw);
}
template <class Real, class Isa>
Batch<Real, Isa> max(Batch<Real, Isa> a, Batch<Real, Isa> b) {
    return xsimd::max(a.raw, b.raw);
}
template <class Real, class Isa>
Batch<Real, Isa> binade(Batch<Real, Isa> a) {
    // Minus infinity has the bits of sign and exponent set, and no others.
    return a.raw & typename Batch<Real, Isa>::Raw(-__builtin_inf());
}
template <class Real, class Isa>
Batch<Real, Isa> select(xsimd::batch_bool<Real, Isa> mask, Batch<Real, Isa> if_true,
                        Batch<Real, Isa> if_false) {
    return xsimd::select(mask, if_true.raw, if_false.raw);
}
template <class Real, class Isa>
bool any(xsimd::batch_bool<Real, Isa> mask) {
    return xsimd::any(mask);
}
template <class Real, class Isa>
bool all(xsimd::batch_bool<Real, Isa> mask) {
    return xsimd::all(mask);
}

/// The operations that all x86 batches share; the instruction sets add their own below.
template <class Real, class Isa>
struct BatchLanes {
    using Number = Real;
    using Batch = simd::Batch<Real, Isa>;
    using Mask = typename Batch::Mask;
    static constexpr std::size_t size = Batch::Raw::size;

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

    static Batch broadcast(Real value) { return Batch(value); }
    static Batch load(const Real* from) { return Batch::Raw::load_aligned(from); }
    static Batch load_unaligned(const Real* from) { return Batch::Raw::load_unaligned(from); }
    static void store(Real* to, Batch value) { value.raw.store_aligned(to); }
    static void store_unaligned(Real* to, Batch value) { value.raw.store_unaligned(to); }
    static void scatter_at(Real* column, const std::int32_t* rows, Batch value) {
        alignas(64) Real lane[size];
        store(lane, value);
        for (std::size_t i = 0; i < size; ++i) column[rows[i]] = lane[i];
    }
};

}  // namespace
}  // namespace carom::simd

#pragma once

#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/rotation.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Cosines and sines with the bits of rotation_by() in math/rotation.hpp, which says how.
template <class L, class F = typename L::Batch>
[[gnu::always_inline]] inline void turn_batch(F angle, F& of_cosine, F& of_sine) {
    using simd::select;
    const F to_whole(RotationSeries::kToWhole), zero(0), one(1);
    const auto whole = [&](F value) { return (value + to_whole) - to_whole; };
    const F quarters = whole(angle * F(RotationSeries::kTwoOverPi));
    F x = angle;
    for (const double part : RotationSeries::kPart) x -= quarters * F(part);
    const F square = x * x;
    F c = zero, s = zero;
    for (const double factor : RotationSeries::kOfCosine) c = c * square + F(factor);
    for (const double factor : RotationSeries::kOfSine) s = s * square + F(factor);
    s *= x;
    // Quarters of a turn that are left of whole turns: -2 ... 2.
    const F left = quarters - F(4) * whole(quarters * F(0.25));
    const auto is_odd = simd::abs(left) == one, is_half = simd::abs(left) > one;
    const F cosine = select(is_odd, select(left > zero, -s, s), select(is_half, -c, c));
    const F sine = select(is_odd, select(left > zero, c, -c), select(is_half, -s, s));
    const auto has_direction = simd::abs(angle) <= F(RotationSeries::kLargest);
    of_cosine = select(has_direction, cosine, one);
    of_sine = select(has_direction, sine, zero);
}

/// The same of a block of angles.
template <class Isa>
void turn_angles(const double* angles, double* cosines, double* sines) {
    using L = simd::Lanes<double, Isa>;
    for (std::size_t i = 0; i < kAnglesOfBlock; i += L::size) {
        typename L::Batch cosine, sine;
        turn_batch<L>(L::load(angles + i), cosine, sine);
        L::store(cosines + i, cosine), L::store(sines + i, sine);
    }
}

}  // namespace
}  // namespace carom

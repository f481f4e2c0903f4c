#pragma once

#include "kernels/manifolds/manifold_arguments.hpp"
#include "math/rotation.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Cosines and sines with the bits of rotation_by() in math/rotation.hpp, which says how.
template <class Isa>
void turn_angles(const double* angles, double* cosines, double* sines) {
    using L = simd::Lanes<double, Isa>;
    using F = typename L::Batch;
    using simd::select;
    const F to_whole(RotationSeries::kToWhole), zero(0), one(1);
    const auto whole = [&](F value) { return (value + to_whole) - to_whole; };
    for (std::size_t i = 0; i < kAnglesOfBlock; i += L::size) {
        const F angle = L::load(angles + i);
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
        L::store(cosines + i, select(has_direction, cosine, one));
        L::store(sines + i, select(has_direction, sine, zero));
    }
}

}  // namespace
}  // namespace carom

#pragma once

#include <cmath>

#include "math/vec2_math.hpp"

// Cosine and sine from + - * and floor alone, so that every machine gets the same bits.

namespace carom {

/// A turn of the plane about the origin, counter-clockwise.
struct Rotation {
    double cos = 1;
    double sin = 0;
};

/// Numbers of rotation_by(), which is also written for lanes: kernels/manifolds/turn_angles.hpp.
struct RotationSeries {
    static constexpr double kLargest = 1e15;  // rad
    static constexpr double kPart[] = {0x1.921fb5p+0, 0x1.110b46p-26, 0x1.1a6263p-54, 0x1.8a2e03707344ap-81};
    static constexpr double kTwoOverPi = 0.63661977236758134308;
    static constexpr double kToWhole = 0x1.8p52;  // added and taken away again, it leaves a whole number
    // The series in x², the highest power first: 16th to 0th of the cosine, 15th to 1st of the sine.
    static constexpr double kOfCosine[] = {1. / 20922789888000,
                                           -1. / 87178291200,
                                           1. / 479001600,
                                           -1. / 3628800,
                                           1. / 40320,
                                           -1. / 720,
                                           1. / 24,
                                           -1. / 2,
                                           1};
    static constexpr double kOfSine[] = {-1. / 1307674368000, 1. / 6227020800, -1. / 39916800, 1. / 362880,
                                         -1. / 5040,          1. / 120,        -1. / 6,        1};
};

/// The turn by `angle` [rad]. Within 1e-15 for |angle| <= 1e8 rad, which is as far as scenes go.
///
/// The angle is reduced to |x| <= π/4 by subtracting a whole number of π/2, which is kept in four parts of 26
/// bits, so that whole number times part is exact (Cody & Waite 1980). The rest are Taylor's series: x^17/17!
/// and x^18/18! of π/4 are below 2^-53. Beyond 1e15 rad, where numbers are a turn's eighth and more apart,
/// the angle says no direction: then, and where it is no number, there is no turn.
///
/// Cost: about 60 operations, none of them a division, and no call.
inline Rotation rotation_by(double angle) {
    using Series = RotationSeries;
    if (!(std::fabs(angle) <= Series::kLargest)) return {};
    const double quarters = (angle * Series::kTwoOverPi + Series::kToWhole) - Series::kToWhole;
    double x = angle;
    for (const double part : Series::kPart) x -= quarters * part;
    const double square = x * x;
    double c = 0, s = 0;
    for (const double factor : Series::kOfCosine) c = c * square + factor;
    for (const double factor : Series::kOfSine) s = s * square + factor;
    s *= x;
    switch (static_cast<long long>(quarters) & 3) {
        case 0:
            return {c, s};
        case 1:
            return {-s, c};
        case 2:
            return {-c, -s};
        default:
            return {s, -c};
    }
}

constexpr Vec2 rotate(const Rotation& by, Vec2 v) {
    return {by.cos * v.x - by.sin * v.y, by.sin * v.x + by.cos * v.y};
}
constexpr Vec2 rotate_back(const Rotation& by, Vec2 v) {
    return {by.cos * v.x + by.sin * v.y, by.cos * v.y - by.sin * v.x};
}

}  // namespace carom

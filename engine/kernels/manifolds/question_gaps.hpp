#pragma once

#include <limits>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Tells which contacts of the block that begins at `first` have to be looked at one by one; the others stay
/// as they were found: their bodies touch, or have a gap that is not long, that may close where it is and
/// that neither is swift enough to pass. What rounding leaves open is told, too.
/// @return a bit for each
/// @see QuestionGaps
template <class Real, class Isa>
std::uint32_t question_gaps(const QuestionGaps<Real>& k, std::size_t first) {
    using L = simd::Lanes<Real, Isa>;
    using F = typename L::Batch;
    using simd::abs, simd::max, simd::min, simd::sqrt;
    // No velocity or way is the end of more than a dozen sums and products, each off by half of this at most.
    constexpr Real kRounding = 8 * std::numeric_limits<Real>::epsilon();
    const F zero(0), none(static_cast<Real>(kNoPoint)), dt(k.dt), more(1 + kRounding), less(1 - kRounding);
    std::uint32_t found = 0;
    for (std::size_t lane = 0; lane < k.kContacts; lane += L::size) {
        const std::size_t i = first + lane;
        const auto column = [&](const Real* of) { return L::load(of + i); };
        const F s1 = column(k.found.separation1), s2 = column(k.found.separation2),
                thickness = column(k.thickness), gap = min(s1, s2);
        const auto is_beside = (s2 >= none) & (abs(s1) <= F(k.beside) * thickness * more);
        const auto is_open = (gap > zero) & (s1 < none);
        auto bits = static_cast<std::uint32_t>(simd::bitmask(is_beside));
        const auto open_bits = static_cast<std::uint32_t>(simd::bitmask(is_open));
        if (open_bits != 0) {
            const auto at_a = [&](const Real* of) { return L::gather_at(of, k.a + i); };
            const auto at_b = [&](const Real* of) { return L::gather_at(of, k.b + i); };
            const F ax = at_a(k.velocity_x), ay = at_a(k.velocity_y), bx = at_b(k.velocity_x),
                    by = at_b(k.velocity_y), nx = column(k.found.normal_x), ny = column(k.found.normal_y);
            const F wa = k.spin ? at_a(k.spin) : zero, wb = k.spin ? at_b(k.spin) : zero;
            const F ra = k.radius ? at_a(k.radius) : F(k.uniform_radius),
                    rb = k.radius ? at_b(k.radius) : F(k.uniform_radius);
            const F dx = bx - ax, dy = by - ay;
            const F way = dt * (sqrt(dx * dx + dy * dy) + abs(wa) * ra + abs(wb) * rb) * more;
            const auto is_swift = (way > F(k.swift) * thickness) & (way > gap * less);
            const F va = ax * nx + ay * ny, vb = bx * nx + by * ny, e = column(k.restitution);
            const F of_a1 = wa * column(k.found.lever_a1), of_a2 = wa * column(k.found.lever_a2),
                    of_b1 = wb * column(k.found.lever_b1), of_b2 = wb * column(k.found.lever_b2);
            const F off = F(kRounding) * (dt * (abs(ax) + abs(ay) + abs(bx) + abs(by) +
                                                max(abs(of_a1), abs(of_a2)) + max(abs(of_b1), abs(of_b2))));
            const auto towards = [&](F speed) { return max(speed, -e * speed); };
            const F reach = (F(k.share) * thickness + F(k.fall)) * less - off;
            const auto closes = [&](F s, F of_a, F of_b) {
                return s * more <= reach + dt * (towards(va + of_a) + towards(-vb - of_b)) * less;
            };
            const auto stays = closes(s1, of_a1, of_b1) | closes(s2, of_a2, of_b2);
            const F closing = vb - va, then1 = s1 * less + dt * (closing + of_b1 - of_a1) - off,
                    then2 = s2 * less + dt * (closing + of_b2 - of_a2) - off;
            const auto passes = min(then1, then2) < -F(k.passing) * thickness * less;
            const auto is_far = gap > F(k.far) * (ra + rb);
            bits |=
                open_bits & static_cast<std::uint32_t>(simd::bitmask(is_swift | passes | is_far | !stays));
        }
        found |= bits << lane;
    }
    return found;
}

}  // namespace
}  // namespace carom

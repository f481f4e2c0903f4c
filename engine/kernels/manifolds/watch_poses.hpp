#pragma once

#include <cstring>

#include "kernels/manifolds/manifold_arguments.hpp"
#include "simd/consecutive_rows.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// How far bodies have come since the step before, and whether that is too far for contacts to be carried on.
/// @return whether some angle is not that of the step before, or a row has no cosine and sine yet
/// @see WatchPoses
template <class Real, class Isa>
bool watch_poses(const WatchPoses<Real>& k, std::size_t first, std::size_t last) {
    using L = simd::Lanes<Real, Isa>;
    using F = typename L::Batch;
    using simd::abs;
    const F zero(0), dt(k.dt);
    bool has_turned = false;
    const auto of_row = [](const Real* column, Real uniform, std::size_t row) {
        return column ? L::load(column + row) : F(uniform);
    };
    for (std::size_t row = first; row < last; row += L::size) {
        auto pose = L::load_rows4(k.pose + 4 * row, kConsecutive),
             base = L::load_rows4(k.base + 4 * row, kConsecutive);
        const F x = L::load(k.x + row), y = L::load(k.y + row), angle = of_row(k.angle, 0, row),
                before = L::load(k.last_angle + row), radius = of_row(k.radius, k.uniform_radius, row);
        has_turned =
            has_turned || simd::any((abs(angle - before) > zero) | ((pose[2] == zero) & (pose[3] == zero)));
        auto come = L::load_rows2(k.come + 2 * row, kConsecutive);
        come[0] = x - pose[0], come[1] = y - pose[1];
        const F turned = angle - before;
        L::store_rows2(k.come + 2 * row, kConsecutive, come);
        L::store(k.turned + row, turned * of_row(k.rim, k.uniform_rim, row));
        L::store(k.moved + row, abs(come[0]) + abs(come[1]) + abs(turned) * radius);
        pose[0] = x, pose[1] = y;
        L::store_rows4(k.pose + 4 * row, kConsecutive, pose), L::store(k.last_angle + row, angle);
        const F thinnest = L::load(k.thinnest + row), away = abs(x - base[0]) + abs(y - base[1]),
                turn = angle - base[2];
        const F speed = abs(L::load(k.velocity_x + row)) + abs(L::load(k.velocity_y + row)) +
                        abs(of_row(k.spin, 0, row)) * radius;
        const F way = dt * speed;
        L::store(k.way + row, way);
        const auto is_still = (away <= F(k.carried_share) * thinnest) &
                              (turn * turn * radius <= F(k.carried_arc) * thinnest) &
                              (way <= F(k.carried_way) * thinnest);
        const auto still = static_cast<unsigned>(simd::bitmask(is_still));
        constexpr unsigned kAll = (1u << L::size) - 1;
        if ((still & kAll) == kAll) {
            std::memset(k.has_moved + row, 0, L::size);
            if (!simd::any(thinnest == zero)) continue;
        } else {
            for (std::size_t lane = 0; lane < L::size; ++lane)
                k.has_moved[row + lane] = static_cast<std::uint8_t>(1 & ~(still >> lane));
        }
        const auto stays = is_still & (thinnest > zero);
        base[0] = simd::select(stays, base[0], x), base[1] = simd::select(stays, base[1], y);
        base[2] = simd::select(stays, base[2], angle);
        L::store_rows4(k.base + 4 * row, kConsecutive, base);
    }
    return has_turned;
}

}  // namespace
}  // namespace carom

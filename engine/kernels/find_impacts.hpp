#pragma once

#include "kernels/find_near.hpp"
#include "kernels/flight_arguments.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// Whether two points at relative position d, moving by v relative to each other for s, come nearer than
/// reach while approaching. Needs neither a root nor a division: the distance squared, c + 2 b t + a t² +
/// reach², falls below reach² either at the end or at the closest point on the way, t = -b/a.
template <class F>
auto approaches_within(F dx, F dy, F vx, F vy, F reach, F s) {
    const F zero(0);
    const F a = vx * vx + vy * vy;
    const F b = dx * vx + dy * vy;
    const F c = dx * dx + dy * dy - reach * reach;
    const F a_s = a * s;
    const auto inside_at_end = c + (b + b + a_s) * s < zero;
    const auto inside_on_the_way = (zero - b < a_s) & (a * c < b * b);
    return (b < zero) & (inside_at_end | inside_on_the_way);
}

template <bool kUniformRadius, class Real, class Isa>
std::size_t find_impacts(const FindImpacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F s(k.s), slack(k.slack), near(k.near);
    const F uniform_reach(k.uniform_radius + k.uniform_radius);
    std::int32_t lanes[16];
    for (std::size_t n = 0; n < 16; ++n) lanes[n] = static_cast<std::int32_t>(n);
    std::size_t count = 0;
    for (std::size_t p = first; p < last; p += Lanes::size) {
        const auto a = Lanes::load_rows4(k.motion, k.a + p);
        const auto b = Lanes::load_rows4(k.motion, k.b + p);
        const F dx = b[0] - a[0], dy = b[1] - a[1];
        F reach = uniform_reach;
        if constexpr (!kUniformRadius)
            reach = Lanes::gather(k.radius, Lanes::load_rows(k.a + p)) +
                    Lanes::gather(k.radius, Lanes::load_rows(k.b + p));
        const F near_reach = reach + near;
        const auto found = approaches_within(dx, dy, b[2] - a[2], b[3] - a[3], reach + slack, s) |
                           (dx * dx + dy * dy < near_reach * near_reach);
        const unsigned bits = simd::bitmask(found);
        if (bits == 0) continue;
        const std::size_t before = count;
        count += Lanes::compress_store(k.found + before, Lanes::load_rows(lanes), bits);
        for (std::size_t n = before; n < count; ++n) k.found[n] += static_cast<std::int32_t>(p);
    }
    return count;
}

/// Most lists are not longer; looking at so many rows always takes no branch that depends on the number.
constexpr std::size_t kUsualNeighbours = 16;

/// Of listed rows keeps those that k.row may meet, in order. The list has room for kUsualNeighbours more.
template <bool kUniformRadius, class Real, class Isa>
std::size_t keep_impacts_of(const FindImpactsNear<Real>& k, std::int32_t* rows, std::size_t listed) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const Real* own = k.motion + 4 * static_cast<std::ptrdiff_t>(k.row);
    const F x(own[0]), y(own[1]), vx(own[2]), vy(own[3]);
    const F from(k.from), duration(k.until - k.from), slack(k.slack);
    const Real own_radius = kUniformRadius ? k.uniform_radius : k.radius[k.row];
    std::size_t count = 0;
    std::size_t end = listed;
    if constexpr (Lanes::size > 1) {
        const auto own_row = Lanes::broadcast_row(k.row);  // which never meets itself
        for (std::size_t n = 0; n < kUsualNeighbours; n += Lanes::size)
            Lanes::store_rows(rows + listed + n, own_row);
        if (end < kUsualNeighbours) end = kUsualNeighbours;
    }
    for (std::size_t n = 0; n < end; n += Lanes::size) {
        const auto other = Lanes::load_rows4(k.motion, rows + n);
        const auto other_rows = Lanes::load_rows(rows + n);
        F reach(own_radius + own_radius);
        if constexpr (!kUniformRadius) reach = F(own_radius) + Lanes::gather(k.radius, other_rows);
        const F relative_x = other[2] - vx, relative_y = other[3] - vy;
        const F dx = other[0] - x + relative_x * from, dy = other[1] - y + relative_y * from;
        const F close = reach + slack;
        unsigned found = simd::bitmask(approaches_within(dx, dy, relative_x, relative_y, close, duration));
        if (k.slack > Real(0)) {
            const unsigned near = simd::bitmask(dx * dx + dy * dy < close * close);
            found |= n + Lanes::size <= listed ? near : n < listed ? near & ((1u << (listed - n)) - 1u) : 0u;
        }
        count += Lanes::compress_store(rows + count, other_rows, found);
    }
    return count;
}

/// Which of the cells' bodies are near is not asked: nearly all are, and reading where they were costs as
/// many cache lines as reading where they are.
/// @return how many rows were found, or kNoRoom
template <bool kUniformRadius, class Real, class Isa>
std::size_t find_impacts_near(const GridLevel<Real>& level, const FindImpactsNear<Real>& k) {
    using L = simd::ShortLanes<Real, Isa>;
    if (k.capacity < kUsualNeighbours) return kNoRoom;
    const FindNear<Real> around{k.x, k.y, k.reach, k.found, k.capacity - kUsualNeighbours};
    const std::size_t listed = pick_around<L>(level, around, PickAll<L, Real>{level.bodies});
    if (listed == kNoRoom) return kNoRoom;
    return keep_impacts_of<kUniformRadius, Real, Isa>(k, k.found, listed);
}

}  // namespace
}  // namespace carom

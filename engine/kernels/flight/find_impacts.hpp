#pragma once

#include "kernels/broadphase/find_near.hpp"
#include "kernels/flight/flight_arguments.hpp"
#include "simd/lanes.hpp"
#include "simd/prefetch.hpp"

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
    const F b_at_end = b + a * s;
    const auto inside_at_end = c + (b + b_at_end) * s < zero;
    const auto inside_on_the_way = (b_at_end > zero) & (a * c < b * b);
    return (b < zero) & (inside_at_end | inside_on_the_way);
}

// The bodies b of pairs are read in the order of the plane's next line, which memory does not guess.
constexpr std::size_t kPairsAhead = 256;
constexpr std::size_t kPairsOfLine = 4;  // at least so many share a cache line

template <bool kUniformRadius, class Real, class Isa>
std::size_t find_impacts(const FindImpacts<Real>& arguments, std::size_t first, std::size_t last) {
    const FindImpacts<Real> k = arguments;  // in registers: what is written could be they, for all gcc knows
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F s(k.s), slack(k.slack), near(k.near);
    const F uniform_reach(k.uniform_radius + k.uniform_radius);
    std::int32_t lanes[16];
    for (std::size_t n = 0; n < 16; ++n) lanes[n] = static_cast<std::int32_t>(n);
    const auto next = Lanes::broadcast_row(static_cast<std::int32_t>(Lanes::size));
    auto numbers =
        Lanes::rows_sum(Lanes::load_rows(lanes), Lanes::broadcast_row(static_cast<std::int32_t>(first)));
    std::size_t count = 0;
    for (std::size_t p = first; p < last; p += Lanes::size) {
        const std::size_t soon = p + kPairsAhead < last ? p + kPairsAhead : last - Lanes::size;
        for (std::size_t n = 0; n < Lanes::size; n += kPairsOfLine)
            prefetch(k.motion + 4 * static_cast<std::ptrdiff_t>(k.b[soon + n]));
        const auto relative = Lanes::load_differences4(k.motion, k.b + p, k.a + p);
        const F dx = relative[0], dy = relative[1];
        F reach = uniform_reach;
        if constexpr (!kUniformRadius)
            reach = Lanes::gather_at(k.radius, k.a + p) + Lanes::gather_at(k.radius, k.b + p);
        const F near_reach = reach + near;
        const auto found = approaches_within(dx, dy, relative[2], relative[3], reach + slack, s) |
                           (dx * dx + dy * dy < near_reach * near_reach);
        // Written whether or not there is one: a branch would often be guessed wrongly.
        count += Lanes::compress_store(k.found + count, numbers, simd::bitmask(found));
        numbers = Lanes::rows_sum(numbers, next);
    }
    return count;
}

/// Writes the rows of those bodies of a range that body k.row may meet, itself if slack > 0.
template <bool kUniformRadius, class L, class Real>
struct PickMet {
    using F = typename L::Batch;

    const SortedBodies<Real>& bodies;
    const Real* motion;
    const Real* radius;
    F x, y, vx, vy, own_reach, from, duration, slack;
    bool has_slack;

    PickMet(const SortedBodies<Real>& sorted, const FindImpactsNear<Real>& k)
        : bodies(sorted),
          motion(k.motion),
          radius(k.radius),
          from(L::broadcast(k.from)),
          duration(L::broadcast(k.until - k.from)),
          slack(L::broadcast(k.slack)),
          has_slack(k.slack > 0) {
        const Real* own = k.motion + 4 * static_cast<std::ptrdiff_t>(k.row);
        x = L::broadcast(own[0]), y = L::broadcast(own[1]);
        vx = L::broadcast(own[2]), vy = L::broadcast(own[3]);
        own_reach = L::broadcast(kUniformRadius ? k.uniform_radius + k.uniform_radius : k.radius[k.row]);
    }

    /// Writes the rows of those that are met of `count` <= L::size places; `out` has room for a batch.
    /// @return how many it wrote
    std::size_t operator()(std::size_t place, std::size_t count, std::int32_t* out) const {
        const auto other = L::load_rows4(motion, bodies.row + place);
        const auto rows = L::load_rows(bodies.row + place);
        F reach = own_reach;
        if constexpr (!kUniformRadius) reach = own_reach + L::gather_at(radius, bodies.row + place);
        const F relative_x = other[2] - vx, relative_y = other[3] - vy;
        const F dx = other[0] - x + relative_x * from, dy = other[1] - y + relative_y * from;
        const F close = reach + slack;
        auto met = approaches_within(dx, dy, relative_x, relative_y, close, duration);
        if (has_slack) met = met | (dx * dx + dy * dy < close * close);
        return L::compress_store(out, rows, simd::bitmask(met) & ((1u << count) - 1u));
    }
};

/// Tests the bodies in the cells where they are now, without asking first which were near when the grid was
/// built: nearly all were, and reading where they were costs as many cache lines.
/// @return how many rows were found, or kNoRoom
template <bool kUniformRadius, class Real, class Isa>
std::size_t find_impacts_near(const GridLevel<Real>& level, const FindImpactsNear<Real>& k) {
    using L = simd::ShortLanes<Real, Isa>;
    const PickMet<kUniformRadius, L, Real> pick(level.bodies, k);
    return pick_around<L>(level, FindNear<Real>{k.x, k.y, k.reach, k.found, k.capacity}, pick);
}

}  // namespace
}  // namespace carom

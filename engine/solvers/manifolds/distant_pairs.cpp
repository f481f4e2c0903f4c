#include "solvers/manifolds/distant_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace carom {
namespace {

constexpr std::size_t kPairsPerTask = 4096;
constexpr double kNanosecondsToScan = 2;  // a pair, on one thread, for the executor

constexpr std::int32_t kTaken = -1;  // row of a pair that was taken out

/// Share of the lengths in it by which a gap may be off through rounding.
template <class Real>
constexpr Real kRounding = 16 * std::numeric_limits<Real>::epsilon();

}  // namespace

template <class Real>
void DistantPairs<Real>::add(const WorldState<Real>& world, std::int32_t a, std::int32_t b) {
    pairs_.push_back({a, b,
                      pair_thickness(world.bodies, static_cast<std::size_t>(a), static_cast<std::size_t>(b)),
                      -std::numeric_limits<Real>::infinity()});
}

/// Largest of the gaps along the sides of both rectangles, less what rounding may make of it.
template <class Real>
Real DistantPairs<Real>::gap(const Frame& a, const Real* pose_a, const Frame& b, const Real* pose_b) {
    const Real ca = pose_a[2], sa = pose_a[3], cb = pose_b[2], sb = pose_b[3];
    const Real x = pose_b[0] - pose_a[0] + (cb * b.x - sb * b.y) - (ca * a.x - sa * a.y),
               y = pose_b[1] - pose_a[1] + (sb * b.x + cb * b.y) - (sa * a.x + ca * a.y);
    const Real c = std::fabs(ca * cb + sa * sb), s = std::fabs(ca * sb - sa * cb);
    const Real of_a = std::max(std::fabs(ca * x + sa * y) - a.half_x - (b.half_x * c + b.half_y * s),
                               std::fabs(ca * y - sa * x) - a.half_y - (b.half_x * s + b.half_y * c));
    const Real of_b = std::max(std::fabs(cb * x + sb * y) - b.half_x - (a.half_x * c + a.half_y * s),
                               std::fabs(cb * y - sb * x) - b.half_y - (a.half_x * s + a.half_y * c));
    return std::max(of_a, of_b) - kRounding<Real> * (a.half_x + a.half_y + b.half_x + b.half_y);
}

template <class Real>
std::span<const typename DistantPairs<Real>::Pair> DistantPairs<Real>::take_near(
    const WorldState<Real>& world, const PoseWatch<Real>& poses, const ContactDistance& near,
    const Executor& executor) {
    taken_.clear();
    if (pairs_.empty()) return taken_;
    frames_.follow(world.shapes);
    const auto share = static_cast<Real>(near.share), fall = static_cast<Real>(near.fall);
    const Column<std::int32_t>& shape_of = world.bodies.shape;
    near_.prepare(pairs_.size(), kPairsPerTask);
    executor.for_each_chunk(
        pairs_.size(), kPairsPerTask, kNanosecondsToScan,
        [&](std::size_t chunk, std::size_t first, std::size_t last) {
            std::int32_t* out = near_.part(chunk);
            std::size_t count = 0;
            for (std::size_t n = first; n < last; ++n) {
                Pair& pair = pairs_[n];
                const auto a = static_cast<std::size_t>(pair.a), b = static_cast<std::size_t>(pair.b);
                const auto ways = static_cast<Real>(poses.path(a) + poses.path(b));
                const Real reach = ways + poses.way(a) + poses.way(b) + (share * pair.thickness + fall);
                if (reach <= pair.until) continue;
                const Real apart =
                    gap(frames_[shape_of[a]], &poses.pose[4 * a], frames_[shape_of[b]], &poses.pose[4 * b]);
                pair.until = ways + apart - kRounding<Real> * reach;
                if (!(reach <= pair.until)) out[count++] = static_cast<std::int32_t>(n);
            }
            near_.set_count(chunk, count);
        });
    near_.for_each_below(pairs_.size(), [&](std::int32_t n) {
        Pair& pair = pairs_[static_cast<std::size_t>(n)];
        taken_.push_back(pair);
        pair.a = kTaken;
    });
    if (!taken_.empty()) std::erase_if(pairs_, [](const Pair& pair) { return pair.a == kTaken; });
    return taken_;
}

template <class Real>
std::size_t DistantPairs<Real>::bytes() const {
    return (pairs_.capacity() + taken_.capacity()) * sizeof(Pair) + frames_.bytes() + near_.bytes();
}

template class DistantPairs<float>;
template class DistantPairs<double>;

}  // namespace carom

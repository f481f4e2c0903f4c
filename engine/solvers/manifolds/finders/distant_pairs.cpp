#include "solvers/manifolds/finders/distant_pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace carom {
namespace {

constexpr std::size_t kPairsPerTask = 4096, kRowsPerTask = 1024;  // some microseconds of work a task
// For the executor, on one thread: ns a pair; ns a row or a new pair.
constexpr double kNanosecondsToScan = 2, kNanosecondsToDescribe = 2;

constexpr std::size_t kPairsOfGap = 8;  // gaps are closed when one pair in so many is one

/// Share of the lengths in it by which a gap may be off through rounding.
template <class Real>
constexpr Real kRoundingOfLengths = 16 * std::numeric_limits<Real>::epsilon();

}  // namespace

template <class Real>
void DistantPairs<Real>::clear() {
    a_.clear(), b_.clear(), thickness_.clear(), until_.clear();
    gaps_ = 0;
    frame_.clear();  // rows may have changed
}

/// Pairs that were added since the last step are to be looked at.
template <class Real>
void DistantPairs<Real>::describe_new_pairs(const WorldState<Real>& world, const Executor& executor) {
    const std::size_t known = thickness_.size();
    thickness_.resize(count()), until_.resize(count());
    executor.for_each_chunk(count() - known, kPairsPerTask, kNanosecondsToDescribe,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t n = known + first; n < known + last; ++n) {
                                    thickness_[n] =
                                        pair_thickness(world.bodies, static_cast<std::size_t>(a_[n]),
                                                       static_cast<std::size_t>(b_[n]));
                                    until_[n] = -std::numeric_limits<Real>::infinity();
                                }
                            });
}

/// What rows have come since pairs were listed, and may come in this step; and their rectangles.
template <class Real>
void DistantPairs<Real>::describe_rows(const WorldState<Real>& world, double dt, const PoseWatch<Real>& poses,
                                       const Executor& executor) {
    const Bodies<Real>& bodies = world.bodies;
    const std::size_t rows = bodies.rows();
    come_.resize_for_overwrite(rows), way_.resize_for_overwrite(rows);
    motion_.resize_for_overwrite(4 * rows);
    const auto h = static_cast<Real>(dt);
    const auto describe = [&](std::size_t row) {
        way_[row] = poses.way(row);
        come_[row] = static_cast<Real>(poses.path(row)) + way_[row];
        const Real moving = way_[row] > 0 ? h : 0;  // what nothing moves may have a velocity all the same
        Real* motion = &motion_[4 * row];
        motion[0] = moving * bodies.velocity_x[row], motion[1] = moving * bodies.velocity_y[row];
        motion[2] = bodies.has_rotation
                        ? moving * std::fabs(bodies.angular_velocity[row]) * bodies.radius[row]
                        : Real(0);
        motion[3] = static_cast<Real>(bodies.restitution[row]);
    };
    // What stands or sleeps comes nowhere.
    const std::size_t changed_rows = frame_.size() == rows ? poses.rows_looked_at() : rows;
    executor.for_each_chunk(changed_rows, kRowsPerTask, kNanosecondsToDescribe,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t row = first; row < last; ++row) describe(row);
                            });
    if (frame_.size() == rows) return;
    frames_.follow(world.shapes);
    frame_.resize_for_overwrite(rows);
    for (std::size_t row = 0; row < rows; ++row) {
        const std::int32_t shape = world.bodies.shape[row];
        frame_[row] = shape < 0 ? ShapeFrame<Real>{} : frames_[shape];
    }
}

template <class Real>
std::span<const typename DistantPairs<Real>::Pair> DistantPairs<Real>::take_near(
    const WorldState<Real>& world, double dt, bool sides_part, const PoseWatch<Real>& poses,
    const ContactDistance& near, const ConvexKernels<Real>& kernels, const Executor& executor) {
    taken_.clear();
    if (empty()) return taken_;
    describe_new_pairs(world, executor);
    const std::array<double, 2> within{near.share, near.fall};
    if (std::exchange(within_, within) != within) {
        close_gaps();
        std::fill(until_.begin(), until_.end(), -std::numeric_limits<Real>::infinity());
    }
    describe_rows(world, dt, poses, executor);
    near_.prepare(count(), kPairsPerTask);
    FindApproached<Real> all{poses.pose.data(),
                             &frame_.data()->x,
                             come_.data(),
                             way_.data(),
                             sides_part ? motion_.data() : nullptr,
                             a_.data(),
                             b_.data(),
                             thickness_.data(),
                             until_.data(),
                             static_cast<Real>(near.share),
                             static_cast<Real>(near.fall),
                             kRoundingOfLengths<Real>,
                             nullptr};
    executor.for_each_chunk(count(), kPairsPerTask, kNanosecondsToScan,
                            [&](std::size_t chunk, std::size_t first, std::size_t last) {
                                FindApproached<Real> k = all;
                                k.out = near_.part(chunk);
                                near_.set_count(chunk, kernels.find_approached(k, first, last));
                            });
    near_.for_each_below(count(), [&](std::int32_t number) {
        const auto n = static_cast<std::size_t>(number);
        taken_.push_back({a_[n], b_[n]});
        thickness_[n] = kTaken, until_[n] = std::numeric_limits<Real>::infinity();
    });
    gaps_ += taken_.size();
    if (kPairsOfGap * gaps_ > count()) close_gaps();
    return taken_;
}

/// Closes the gaps that pairs have left which were taken out. Until then they are never looked at.
template <class Real>
void DistantPairs<Real>::close_gaps() {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < count(); ++n) {
        if (thickness_[n] == kTaken) continue;
        a_[kept] = a_[n], b_[kept] = b_[n], thickness_[kept] = thickness_[n], until_[kept] = until_[n];
        ++kept;
    }
    a_.resize(kept), b_.resize(kept), thickness_.resize(kept), until_.resize(kept);
    gaps_ = 0;
}

template <class Real>
std::size_t DistantPairs<Real>::bytes() const {
    return a_.bytes() + b_.bytes() + thickness_.bytes() + until_.bytes() + come_.bytes() + way_.bytes() +
           motion_.bytes() + frame_.bytes() + taken_.capacity() * sizeof(Pair) + frames_.bytes() +
           near_.bytes();
}

template class DistantPairs<float>;
template class DistantPairs<double>;

}  // namespace carom

#include "solvers/manifolds/poses/pose_watch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "math/rotation.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

// docs/decisions/0035-contacts-at-rest.md has the measurements behind these.

/// A body whose contacts are carried on has come by less than this share of the thinnest of them since they
/// were found,
constexpr double kCarriedShare = 1e-3;
/// has turned so little that what its points have come off their straight way, radius times turn² / 2, is
/// less than half of this share of it: found again, a contact makes up for that at once, as a speed,
constexpr double kCarriedArc = 1e-6;
/// and comes by less than this share of the distance up to which contacts are found in the step.
constexpr double kCarriedWay = 0.25;

constexpr std::size_t kRowsPerTask = 512;  // some microseconds of work
constexpr double kNanosecondsToLook = 5;   // a row, on one thread, for the executor

}  // namespace

template <class Real>
void PoseWatch<Real>::look(const WorldState<Real>& world, double dt, const ContactDistance& near,
                           bool forgets, const ConvexKernels<Real>& kernels, const Executor& executor) {
    const Bodies<Real>& bodies = world.bodies;
    const std::size_t rows = bodies.rows(), room = padded(rows);
    pose.resize(4 * room), angle_.resize(room), base_.resize(4 * room), has_moved_.resize(room);
    come_.resize(2 * room), turned_.resize(room), thinnest_.resize(room), way_.resize(room);
    moved_.resize(room), path_.resize(rows);
    awake_ = bodies.count;
    if (forgets) std::fill(thinnest_.begin(), thinnest_.end(), Real(0));
    if (forgets || begins_paths_) looks_at_others_ = kLooksAtOthers;
    rows_looked_at_ = looks_at_others_ > 0 ? rows : bodies.moving();
    if (looks_at_others_ > 0) --looks_at_others_;
    const WatchPoses<Real> k = arguments(bodies, dt, near);
    executor.for_each_chunk(rows_looked_at_, kRowsPerTask, kNanosecondsToLook,
                            [&](std::size_t, std::size_t first, std::size_t last) {
                                for (std::size_t row = first; row < last; row += kAnglesOfBlock) {
                                    const std::size_t end = std::min(last, row + kAnglesOfBlock);
                                    if (kernels.watch_poses(k, row, padded(end)))
                                        turn(bodies, kernels, row, end);
                                    look_at_immovable(bodies, row, std::min(rows, padded(end)));
                                }
                                follow_paths(first, last);
                            });
    if (forgets) std::fill(thinnest_.begin(), thinnest_.end(), std::numeric_limits<Real>::infinity());
    for (const std::int32_t row : fresh_rows_)
        thinnest_[static_cast<std::size_t>(row)] = std::numeric_limits<Real>::infinity();
    fresh_rows_.clear();
    begins_paths_ = false;
    look_at_motors(world, dt);
}

template <class Real>
void PoseWatch<Real>::follow_rows(const Bodies<Real>& bodies, std::span<const std::int32_t> now,
                                  std::span<const std::uint8_t> is_elsewhere) {
    if (path_.empty()) return;  // there was no look yet
    looks_at_others_ = kLooksAtOthers;
    changed_.find(bodies.count, now, is_elsewhere);
    const auto zero = [](std::size_t) { return Real(0); };
    for (Column<Real>* column : {&pose, &base_}) changed_.move(*column, zero, 4);
    changed_.move(angle_, zero), changed_.move(thinnest_, zero), changed_.move(path_, zero);
    for (const std::int32_t changed : changed_.rows()) {
        if (!changed_.is_fresh(changed)) continue;
        const auto row = static_cast<std::size_t>(changed);
        fresh_rows_.push_back(changed);  // its thickness is zero until the next look
        const Rotation turn = rotation_by(bodies.has_rotation ? static_cast<double>(bodies.angle[row]) : 0);
        pose[4 * row] = bodies.position_x[row], pose[4 * row + 1] = bodies.position_y[row];
        pose[4 * row + 2] = static_cast<Real>(turn.cos), pose[4 * row + 3] = static_cast<Real>(turn.sin);
        angle_[row] = bodies.has_rotation ? bodies.angle[row] : Real(0);
    }
}

template <class Real>
WatchPoses<Real> PoseWatch<Real>::arguments(const Bodies<Real>& bodies, double dt,
                                            const ContactDistance& near) {
    const auto real = [](double value) { return static_cast<Real>(value); };
    WatchPoses<Real> k{};
    k.x = bodies.position_x.data(), k.y = bodies.position_y.data();
    k.velocity_x = bodies.velocity_x.data(), k.velocity_y = bodies.velocity_y.data();
    if (bodies.has_rotation) k.angle = bodies.angle.data(), k.spin = bodies.angular_velocity.data();
    k.radius = bodies.radius.data(), k.uniform_radius = bodies.radius.uniform_value();
    k.rim = bodies.rim().data(), k.uniform_rim = bodies.rim().uniform_value();
    k.thinnest = thinnest_.data(), k.dt = real(dt);
    k.carried_share = real(kCarriedShare), k.carried_arc = real(kCarriedArc);
    k.carried_way = real(kCarriedWay * near.share);
    k.pose = pose.data(), k.last_angle = angle_.data(), k.base = base_.data();
    k.come = come_.data(), k.turned = turned_.data(), k.moved = moved_.data(), k.way = way_.data();
    k.has_moved = has_moved_.data();
    return k;
}

/// What nothing moves has no way, whatever its velocity is; what moves by itself has moved if it has any.
template <class Real>
void PoseWatch<Real>::look_at_immovable(const Bodies<Real>& bodies, std::size_t first, std::size_t last) {
    for (std::size_t row = first; row < last; ++row) {
        if (row < bodies.count && !bodies.has_flags) continue;
        const bool is_driven = (bodies.flags_of(row) & kKinematic) != 0;
        if (!is_driven && row < bodies.count && !bodies.is_immovable(row)) continue;
        if (!is_driven) {
            way_[row] = 0, has_moved_[row] = 0;
        } else if (way_[row] > 0) {
            has_moved_[row] = 1;
            base_[4 * row] = bodies.position_x[row], base_[4 * row + 1] = bodies.position_y[row];
            base_[4 * row + 2] = angle_[row];
        }
    }
}

template <class Real>
void PoseWatch<Real>::follow_paths(std::size_t first, std::size_t last) {
    if (begins_paths_) return std::fill(&path_[first], &path_[first] + (last - first), 0.0);
    for (std::size_t row = first; row < last; ++row) path_[row] += static_cast<double>(moved_[row]);
}

/// What a motor adds to the motion of its two bodies in a step, by its torque or force on each alone and up
/// to its speed. What hangs on them moves along, but is not looked for.
template <class Real>
void PoseWatch<Real>::look_at_motors(const WorldState<Real>& world, double dt) {
    driven_.clear();
    if (joints_version_ != world.joints.version) {
        joints_version_ = world.joints.version, with_motors_.clear();
        world.joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
            if (joint.has_motor) with_motors_.push_back(static_cast<std::uint32_t>(slot));
        });
    }
    const Bodies<Real>& bodies = world.bodies;
    for (const std::uint32_t slot : with_motors_) {
        const StoredJoint& joint = world.joints[slot];
        struct End {
            std::size_t row = SIZE_MAX;  // of a body that can move
            Vec2 velocity;               // m/s
            double spin = 0;             // rad/s
            double inverse_mass = 0, inverse_inertia = 0;
        };
        const auto end_of = [&](BodyId id) {
            End end;
            if (id == BodyId{}) return end;
            const std::size_t row = world.handles.row_of_slot(id.index);
            if (row >= bodies.count) return end;  // it sleeps, or was quarantined
            end.velocity = {bodies.velocity_x[row], bodies.velocity_y[row]};
            end.spin = bodies.has_rotation ? static_cast<double>(bodies.angular_velocity[row]) : 0;
            if (bodies.is_immovable(row)) return end;
            const double rim = bodies.rim(row);
            end.row = row, end.inverse_mass = bodies.inverse_mass(row);
            end.inverse_inertia = 2 * end.inverse_mass / (rim * rim);
            return end;
        };
        const End a = end_of(joint.a), b = end_of(joint.b);
        const bool slides = joint.type == JointType::prismatic;
        double speed = b.spin - a.spin, inverse = a.inverse_inertia + b.inverse_inertia;
        if (slides) {
            const double angle =
                a.row < bodies.count && bodies.has_rotation ? static_cast<double>(bodies.angle[a.row]) : 0;
            speed = dot(b.velocity - a.velocity, rotate(rotation_by(angle), joint.axis));
            inverse = a.inverse_mass + b.inverse_mass;
        }
        const double more =
            std::fmin(std::fabs(joint.motor_speed - speed), joint.max_motor * dt * inverse);  // m/s or rad/s
        for (const auto& [end, anchor] : {std::pair{a, joint.anchor_a}, {b, joint.anchor_b}}) {
            if (end.row == SIZE_MAX) continue;
            const double arm =
                slides ? 1 : static_cast<double>(bodies.radius[end.row]) + std::sqrt(length_squared(anchor));
            driven_.push_back({end.row, static_cast<Real>(dt * more * arm)});
        }
    }
    std::sort(driven_.begin(), driven_.end(), [](const Driven& left, const Driven& right) {
        return left.row != right.row ? left.row < right.row : left.way < right.way;
    });
    for (const Driven& driven : driven_) {
        way_[driven.row] += driven.way;
        if (driven.way > static_cast<Real>(kCarriedShare) * thinnest_[driven.row]) has_moved_[driven.row] = 1;
    }
}

template <class Real>
Real PoseWatch<Real>::way_of_motors(std::size_t a, std::size_t b) const {
    Real way = 0;
    if (driven_.empty()) return way;
    for (const std::size_t row : {a, b}) {
        auto found =
            std::lower_bound(driven_.begin(), driven_.end(), row,
                             [](const Driven& driven, std::size_t number) { return driven.row < number; });
        for (; found != driven_.end() && found->row == row; ++found) way += found->way;
    }
    return way;
}

/// Cosines and sines of the rows of a block.
template <class Real>
void PoseWatch<Real>::turn(const Bodies<Real>& bodies, const ConvexKernels<Real>& kernels, std::size_t first,
                           std::size_t last) {
    alignas(64) std::array<double, kAnglesOfBlock> angles{}, cosines, sines;
    if (bodies.has_rotation)
        for (std::size_t row = first; row < last; ++row)
            angles[row - first] = static_cast<double>(bodies.angle[row]);
    kernels.turn_angles(angles.data(), cosines.data(), sines.data());
    for (std::size_t row = first; row < last; ++row) {
        pose[4 * row + 2] = static_cast<Real>(cosines[row - first]);
        pose[4 * row + 3] = static_cast<Real>(sines[row - first]);
    }
}

template <class Real>
const Real* PoseWatch<Real>::come(std::size_t rows) {
    if (come_.size() < 2 * rows) come_.resize(2 * rows), turned_.resize(rows);
    std::fill(come_.begin() + static_cast<std::ptrdiff_t>(2 * awake_), come_.end(), Real(0));
    std::fill(turned_.begin() + static_cast<std::ptrdiff_t>(awake_), turned_.end(), Real(0));
    return come_.data();
}

template <class Real>
std::size_t PoseWatch<Real>::bytes() const {
    return pose.bytes() + angle_.bytes() + base_.bytes() + thinnest_.bytes() + has_moved_.bytes() +
           come_.bytes() + turned_.bytes() + moved_.bytes() + way_.bytes() + path_.bytes() +
           driven_.capacity() * sizeof(Driven) + with_motors_.capacity() * sizeof(std::uint32_t);
}

template class PoseWatch<float>;
template class PoseWatch<double>;

}  // namespace carom

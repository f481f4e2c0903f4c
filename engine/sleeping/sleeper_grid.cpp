// The grid of the sleepers, and the bodies that come near them.
#include "sleeping/sleepers.hpp"

#include <algorithm>
#include <cmath>

#include "effects/sleeping.hpp"
#include "math/vec2_math.hpp"

namespace carom {
namespace {

/// Surfaces that are nearer than this share of the sleeper's radius count as touching.
constexpr double kTouchingShare = 0.05;

template <class Real>
Vec2 position_of(const Bodies<Real>& bodies, std::size_t row) {
    return {bodies.position_x[row], bodies.position_y[row]};
}

template <class Real>
Vec2 velocity_of(const Bodies<Real>& bodies, std::size_t row) {
    return {bodies.velocity_x[row], bodies.velocity_y[row]};
}

/// Whether a body can come near a sleeper: one that does not move on its own cannot.
template <class Real>
bool can_come(const Bodies<Real>& bodies, std::size_t row) {
    const std::uint8_t flags = bodies.flags_of(row);
    return (flags & (kDisabled | kEdges | kSensor)) == 0 &&
           ((flags & kImmovable) == 0 || (flags & kKinematic) != 0);
}

}  // namespace

template <class Real>
void Sleepers<Real>::build_grid(const WorldState<Real>& world, const KernelTable<Real>& kernels,
                                const Executor& executor) {
    if (!is_grid_old_) return;
    const Bodies<Real>& bodies = world.bodies;
    for (Column<Real>* column : {&x_, &y_, &reach_}) column->resize(bodies.asleep);
    ids_.resize(bodies.asleep);
    low_x_ = low_y_ = INFINITY, high_x_ = high_y_ = -INFINITY;
    for (std::size_t i = 0; i < bodies.asleep; ++i) {
        const std::size_t row = bodies.count + i;
        const double reach = (1 + kTouchingShare) * static_cast<double>(bodies.radius[row]);
        const Vec2 p = position_of(bodies, row);
        x_[i] = bodies.position_x[row], y_[i] = bodies.position_y[row];
        reach_[i] = static_cast<Real>(reach), ids_[i] = bodies.id[row];
        low_x_ = std::fmin(low_x_, p.x - reach), high_x_ = std::fmax(high_x_, p.x + reach);
        low_y_ = std::fmin(low_y_, p.y - reach), high_y_ = std::fmax(high_y_, p.y + reach);
    }
    grid_.build({bodies.asleep, x_.data(), y_.data(), reach_.data(), nullptr}, kernels, executor);
    is_grid_old_ = false;
}

/// Rows of the sleepers whose reach overlaps that of a place. Sleepers that have woken since the grid was
/// built are still in it.
template <class Real>
std::span<const std::int32_t> Sleepers<Real>::find_near(const WorldState<Real>& world, Vec2 place,
                                                        double reach) {
    near_.clear();
    if (place.x + reach < low_x_ || place.x - reach > high_x_ || place.y + reach < low_y_ ||
        place.y - reach > high_y_ || ids_.empty())
        return near_;
    const std::size_t found = grid_.find_near(static_cast<Real>(place.x), static_cast<Real>(place.y),
                                              static_cast<Real>(reach), places_);
    for (std::size_t i = 0; i < found; ++i) {
        const BodyId id = ids_[static_cast<std::size_t>(places_[i])];
        if (!world.handles.is_alive(id)) continue;
        const std::uint32_t row = world.handles.row_of_slot(id.index);
        if (row >= world.bodies.count) near_.push_back(static_cast<std::int32_t>(row));
    }
    return near_;
}

template <class Real>
void Sleepers<Real>::find_pairs(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                const KernelTable<Real>& kernels, const Executor& executor) {
    if (pairs_of_rebuild_ == candidates.rebuild_count()) return;
    pairs_of_rebuild_ = candidates.rebuild_count();
    pairs_.clear();
    const Bodies<Real>& bodies = world.bodies;
    if (bodies.asleep == 0) return;
    build_grid(world, kernels, executor);
    for (std::size_t row = 0; row < bodies.moving(); ++row) {
        if (!can_come(bodies, row)) continue;
        const double reach = static_cast<double>(candidates.reach()[row]) + candidates.largest_drift();
        for (const std::int32_t sleeper : find_near(world, position_of(bodies, row), reach))
            if ((bodies.flags_of(static_cast<std::size_t>(sleeper)) & kSensor) == 0)
                pairs_.push_back({static_cast<std::int32_t>(row), sleeper});
    }
}

template <class Real>
bool Sleepers<Real>::is_near_any(const WorldState<Real>& world, const Candidates<Real>& candidates,
                                 std::span<const std::int32_t> rows) {
    for (const std::int32_t row : rows) {
        const auto i = static_cast<std::size_t>(row);
        if (can_come(world.bodies, i) &&
            !find_near(world, position_of(world.bodies, i),
                       static_cast<double>(candidates.reach()[i]) + candidates.largest_drift())
                 .empty())
            return true;
    }
    return false;
}

template <class Real>
bool Sleepers<Real>::mark_hit(const WorldState<Real>& world, double dt, double substep) {
    const Bodies<Real>& bodies = world.bodies;
    const double gravity = std::sqrt(length_squared(world.gravity));
    for (const SleeperPair pair : pairs_) {
        const auto row = static_cast<std::size_t>(pair.row), sleeper = static_cast<std::size_t>(pair.sleeper);
        if (world.has_filters() && !world.may_collide(row, sleeper)) continue;
        const bool falls = !bodies.is_immovable(row);
        // What is no disc counts as the disc around it: that wakes some that would not be hit, but misses
        // none.
        const double radius = bodies.radius[row],
                     smaller = std::fmin(bodies.inradius(row), bodies.inradius(sleeper));
        const Vec2 d = position_of(bodies, sleeper) - position_of(bodies, row), v = velocity_of(bodies, row);
        const double rim = bodies.has_rotation ? std::fabs(bodies.angular_velocity[row]) * radius : 0;
        const double speed = std::sqrt(length_squared(v));
        const double slow = falls ? still_speed(gravity, substep, smaller) : 0;
        if (speed <= slow && (falls || rim == 0)) continue;  // if it presses, its impulse wakes
        // Speed that an impact would give the sleeper at most; a kinematic body gives its own.
        const double mass = bodies.mass[row], other = bodies.mass[sleeper];
        const double given = falls ? 2 * speed * mass / (mass + other) : speed;
        if (falls && given <= kWakingShare * still_speed(gravity, substep, bodies.inradius(sleeper)))
            continue;
        // Time at which it comes nearest, flying on as it does now; gravity can bring it as far again.
        const double squared = speed * speed;
        const double t = squared > 0 ? std::fmin(std::fmax(dot(d, v) / squared, 0), dt) : 0;
        const double reach = radius + static_cast<double>(bodies.radius[sleeper]) + kTouchingShare * smaller +
                             (falls ? 0.5 * gravity * dt * dt : 0);
        if (length_squared(d - t * v) < reach * reach) mark(bodies.island[sleeper]);
    }
    return !marked_.empty();
}

template <class Real>
bool Sleepers<Real>::mark_near(const WorldState<Real>& world, Vec2 place, double reach,
                               const KernelTable<Real>& kernels, const Executor& executor) {
    if (world.bodies.asleep == 0) return false;
    build_grid(world, kernels, executor);
    for (const std::int32_t sleeper : find_near(world, place, (1 + kTouchingShare) * reach))
        mark(world.bodies.island[static_cast<std::size_t>(sleeper)]);
    return !marked_.empty();
}

template <class Real>
bool Sleepers<Real>::mark_all(const WorldState<Real>& world) {
    for (std::size_t row = world.bodies.count; row < world.bodies.rows(); ++row)
        mark(world.bodies.island[row]);
    return !marked_.empty();
}

template <class Real>
std::size_t Sleepers<Real>::bytes() const {
    return (kept_.capacity() + woken_.capacity()) * sizeof(Kept) + islands_.bytes() +
           pairs_.capacity() * sizeof(SleeperPair) + grid_.bytes() + x_.bytes() + y_.bytes() +
           reach_.bytes() + ids_.capacity() * sizeof(BodyId) + stays_awake_.capacity() +
           (label_.capacity() + order_.capacity() + marked_.capacity()) * sizeof(std::int32_t);
}

template void Sleepers<float>::build_grid(const WorldState<float>&, const KernelTable<float>&,
                                          const Executor&);
template std::span<const std::int32_t> Sleepers<float>::find_near(const WorldState<float>&, Vec2, double);
template void Sleepers<float>::find_pairs(const WorldState<float>&, const Candidates<float>&,
                                          const KernelTable<float>&, const Executor&);
template bool Sleepers<float>::is_near_any(const WorldState<float>&, const Candidates<float>&,
                                           std::span<const std::int32_t>);
template bool Sleepers<float>::mark_hit(const WorldState<float>&, double, double);
template bool Sleepers<float>::mark_near(const WorldState<float>&, Vec2, double, const KernelTable<float>&,
                                         const Executor&);
template bool Sleepers<float>::mark_all(const WorldState<float>&);
template std::size_t Sleepers<float>::bytes() const;
template void Sleepers<double>::build_grid(const WorldState<double>&, const KernelTable<double>&,
                                           const Executor&);
template std::span<const std::int32_t> Sleepers<double>::find_near(const WorldState<double>&, Vec2, double);
template void Sleepers<double>::find_pairs(const WorldState<double>&, const Candidates<double>&,
                                           const KernelTable<double>&, const Executor&);
template bool Sleepers<double>::is_near_any(const WorldState<double>&, const Candidates<double>&,
                                            std::span<const std::int32_t>);
template bool Sleepers<double>::mark_hit(const WorldState<double>&, double, double);
template bool Sleepers<double>::mark_near(const WorldState<double>&, Vec2, double, const KernelTable<double>&,
                                          const Executor&);
template bool Sleepers<double>::mark_all(const WorldState<double>&);
template std::size_t Sleepers<double>::bytes() const;

}  // namespace carom

#include "solvers/joints/spring_loads.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "constraints/joints/spring_law.hpp"
#include "solvers/joints/joint_step.hpp"

namespace carom {
namespace {

/// Load, (w h)² of springs together, from which on rows are damped; matched rows can follow 4.
constexpr double kMostTogether = 3;

/// What an impulse along the row of a spring changes the velocity of its end on one body by, in whatever
/// pose: 1/kg, or 1/(kg m²) for a spring of an angle.
struct Yield {
    double least = 0, most = 0;
};

template <class Real>
Yield yield_of(const Bodies<Real>& bodies, std::int32_t row, const StoredJoint& joint, bool is_a) {
    if (row < 0) return {};
    const auto r = static_cast<std::size_t>(row);
    const double mass = bodies.inverse_mass(r), inertia = inverse_inertia_of(bodies, r);
    if (joint.type == JointType::revolute || joint.type == JointType::weld) return {inertia, inertia};
    const bool slides = joint.type == JointType::prismatic || joint.type == JointType::wheel;
    // An axis is a lever as long as the way along it, which nothing bounds.
    if (is_a && slides && inertia > 0) return {mass, std::numeric_limits<double>::infinity()};
    return {mass, mass + inertia * length_squared(is_a ? joint.anchor_a : joint.anchor_b)};
}

/// The largest share of one body in what a row yields.
double share_of(const Yield& own, const Yield& others) {
    if (!(own.most > 0)) return 0;
    return own.most < std::numeric_limits<double>::infinity() ? own.most / (own.most + others.least) : 1;
}

}  // namespace

template <class Real>
void SpringLoads::find(const WorldState<Real>& world) {
    springs_.clear(), damping_.clear();
    const Bodies<Real>& bodies = world.bodies;
    const auto moving_row_of = [&](BodyId id) {
        if (id == BodyId{}) return std::int32_t{-1};
        const std::size_t row = world.handles.row_of_slot(id.index);
        return row < bodies.count && !bodies.is_immovable(row) ? static_cast<std::int32_t>(row) : -1;
    };
    world.joints.for_each([&](std::size_t slot, const StoredJoint& joint) {
        if (!joint.is_spring()) return;
        const std::int32_t a = moving_row_of(joint.a), b = moving_row_of(joint.b);
        if (a < 0 && b < 0) return;
        const double w = kTwoPi * joint.frequency;
        const Yield of_a = yield_of(bodies, a, joint, true), of_b = yield_of(bodies, b, joint, false);
        springs_.push_back({static_cast<std::uint32_t>(slot), a, b, w, w * std::sqrt(share_of(of_a, of_b)),
                            w * std::sqrt(share_of(of_b, of_a))});
    });
    slots_ = world.joints.slots();
    sums_.resize(springs_.empty() ? 0 : bodies.count);
    sum_up(std::numeric_limits<double>::infinity());
    largest_ = 0;
    for (const Spring& spring : springs_) largest_ = std::fmax(largest_, square_of(spring));
}

/// Sums up, by row, the springs that are no faster than this [rad/s].
void SpringLoads::sum_up(double most) {
    std::fill(sums_.begin(), sums_.end(), 0);
    for (const Spring& spring : springs_) {
        if (spring.frequency > most) continue;
        if (spring.row_a >= 0) sums_[static_cast<std::size_t>(spring.row_a)] += spring.by_a;
        if (spring.row_b >= 0) sums_[static_cast<std::size_t>(spring.row_b)] += spring.by_b;
    }
}

/// The bound of the square of the frequency that a spring swings with together with those that are summed up
/// [rad²/s²].
double SpringLoads::square_of(const Spring& spring) const {
    const auto with_others = [&](std::int32_t row, double own) {
        return row < 0 ? 0 : own * std::fmax(sums_[static_cast<std::size_t>(row)] - own, 0.0);
    };
    return spring.frequency * spring.frequency + with_others(spring.row_a, spring.by_a) +
           with_others(spring.row_b, spring.by_b);
}

void SpringLoads::begin_step(double h) {
    damping_.clear();
    if (!(h * h * largest_ > kMostTogether)) return;
    // Springs that are too stiff alone take the implicit row, which adds to what holds the others.
    sum_up(kStiffestAlone / h);
    damping_.assign(slots_, {});
    for (const Spring& spring : springs_) {
        const double wh = spring.frequency * h, load = h * h * square_of(spring),
                     beyond = load - kMostTogether;
        if (wh > kStiffestAlone || !(beyond > 0)) continue;
        damping_[spring.slot] = {0.5 * wh * wh * beyond / load, beyond};
    }
}

std::size_t SpringLoads::bytes() const {
    return springs_.capacity() * sizeof(Spring) + sums_.capacity() * sizeof(double) +
           damping_.capacity() * sizeof(Damping);
}

template void SpringLoads::find(const WorldState<float>&);
template void SpringLoads::find(const WorldState<double>&);

}  // namespace carom

#pragma once

#include "kernels/joints/sweep_joints.hpp"

// Springs, ropes, limits and motors by lanes: rows that give way, and rows with bounds. Each has an impulse
// of its own along the one coordinate that they act on, a length (ropes, springs) or an angle.

namespace carom {
namespace {

/// What acts on one coordinate of a batch of joints, solved one after the other for its velocity v.
template <class Lanes, class Real>
struct DriveRows {
    using F = typename Lanes::Batch;
    F spring, motor, low, high;  // N s or N m s, so far in this substep

    DriveRows(const JointColumns<Real>& joints, std::size_t c)
        : spring(Lanes::load(joints.impulse_x + c)),
          motor(Lanes::load(joints.impulse_y + c)),
          low(Lanes::load(joints.impulse_z + c)),
          high(Lanes::load(joints.impulse_w + c)) {}
    void store(const JointColumns<Real>& joints, std::size_t c) const {
        Lanes::store(joints.impulse_x + c, spring), Lanes::store(joints.impulse_y + c, motor);
        Lanes::store(joints.impulse_z + c, low), Lanes::store(joints.impulse_w + c, high);
    }
    F sum() const { return (spring + motor) + (low + high); }

    /// @param off  of the coordinate from where the spring rests  @param at  the coordinate
    /// @param inverse  mass along the coordinate  @return what is added to the sum
    F solve(const SweepJoints<Real>& k, std::size_t c, F off, F at, F v, F inverse) {
        const F one(1), zero(0), per_h(k.per_h);
        const F mass = simd::select(inverse > zero, one / inverse, zero), before = sum();
        const auto take = [&](F& impulse, F now) {
            v += inverse * (now - impulse);
            impulse = now;
        };
        // The row of constraints/joints/spring_law.hpp: (1 + gamma) v' + alpha C + l / m = v before it.
        if (k.has_springs) {
            const F alpha = Lanes::load(k.joints.alpha + c), gamma = Lanes::load(k.joints.gamma + c);
            take(spring, spring - mass * (gamma * v + alpha * off + inverse * spring) / (one + gamma));
        }
        if (k.has_motors) {
            const F most = Lanes::load(k.joints.most + c);
            take(motor, clamp_to(motor + mass * (Lanes::load(k.joints.speed + c) - v), most));
        }
        const Ends ends(k, c);
        const F to_lower = simd::max(at - ends.lower, zero), to_upper = simd::max(ends.upper - at, zero);
        take(low, simd::max(low - mass * (per_h * to_lower + (v - ends.lower_rate)), zero));
        take(high, simd::min(high + mass * (per_h * to_upper - (v - ends.upper_rate)), zero));
        return sum() - before;
    }
    /// Where a coordinate ends at the start of the substep.
    struct Ends {
        F lower, upper, lower_rate{0}, upper_rate{0};

        Ends(const SweepJoints<Real>& k, std::size_t c)
            : lower(Lanes::load(k.joints.lower + c)), upper(Lanes::load(k.joints.upper + c)) {
            if (!k.ends_move) return;
            lower_rate = Lanes::load(k.joints.lower_rate + c);
            upper_rate = Lanes::load(k.joints.upper_rate + c);
            lower = lower - F(k.until_end) * lower_rate, upper = upper - F(k.until_end) * upper_rate;
        }
    };
    /// How far a coordinate is beyond its ends; above zero: above the upper one.
    static F beyond(const SweepJoints<Real>& k, std::size_t c, F at) {
        const F zero(0);
        const Ends ends(k, c);
        return simd::max(at - ends.upper, zero) + simd::min(at - ends.lower, zero);
    }
};

/// Springs and ropes. The coordinate is the length; it grows by curvature as that of a rod does.
template <bool kFirst, class Real, class Isa>
void sweep_springs(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    const F one(1), zero(0), h(k.h), half_h(k.half_h);
    for (std::size_t c = first; c < last; c += Lanes::size) {
        JointSide<Lanes, true> a, b;
        load_velocities<Lanes>(k, c, a, b);
        load_arms<Lanes, true>(k, c, a, b);
        DriveRows<Lanes, Real> rows(k.joints, c);
        const F l = rows.sum();
        F nx = Lanes::load(k.joints.normal_x + c), ny = Lanes::load(k.joints.normal_y + c);
        F per_length, length, inverse;
        if constexpr (kFirst) {
            simd::forget_loads();
            a.push(l * nx, l * ny, one), b.push(l * nx, l * ny, F(-1));
            turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
            auto moved_a = Lanes::load_rows2(k.displacement, k.joints.a + c);
            auto moved_b = Lanes::load_rows2(k.displacement, k.joints.b + c);
            const auto now = direction_of<Lanes>(between<Lanes, true>(k, c, moved_a, moved_b, a, b));
            nx = now.x, ny = now.y, length = now.length, per_length = now.per_length;
            inverse = inverse_mass_along<Lanes, true>(a, b, nx, ny);
            const F off = clamp_to(DriveRows<Lanes, Real>::beyond(k, c, length), F(k.most) * length);
            const F by = -F(k.recovery) * off, p = simd::select(inverse > zero, by / inverse, zero);
            displace<Lanes, true>(k, c, moved_a, moved_b, a, b, {p * nx, p * ny});
            length += by;
            Lanes::store(k.joints.normal_x + c, nx), Lanes::store(k.joints.normal_y + c, ny);
            Lanes::store(k.joints.per_length + c, per_length);
            Lanes::store(k.joints.value + c, length);
            // Velocities have the impulses of the substep before in them, now along what the spring is now.
            a.push(l * nx, l * ny, F(-1)), b.push(l * nx, l * ny, one);
        } else {
            per_length = Lanes::load(k.joints.per_length + c), length = Lanes::load(k.joints.value + c);
            inverse = inverse_mass_along<Lanes, true>(a, b, nx, ny);
        }
        const F strain = F(4) * h * simd::abs(l) * inverse * per_length;
        const F share = one / (one + strain * strain);
        const Pair2<F> v = parting<Lanes, true>(a, b, h, share, share);
        const F across = v.y * nx - v.x * ny;
        const F along = (v.x * nx + v.y * ny) + growth_of_turn<Lanes>(across, half_h, per_length) * share;
        const F added = rows.solve(k, c, length - Lanes::load(k.joints.length + c), length, along, inverse);
        rows.store(k.joints, c);
        a.push(added * nx, added * ny, F(-1)), b.push(added * nx, added * ny, one);
        store_velocities<Lanes>(k, c, a, b);
    }
}

/// Likewise, the impulses that they had at the end of the step before.
template <class Real, class Isa>
void give_springs(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    const F one(1), zero(0);
    for (std::size_t c = first; c < last; c += Lanes::size) {
        JointSide<Lanes, true> a, b;
        load_velocities<Lanes>(k, c, a, b);
        load_arms<Lanes, true>(k, c, a, b);
        turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
        const typename Lanes::Batch2 still{{zero, zero}};
        const auto n = direction_of<Lanes>(between<Lanes, true>(k, c, still, still, a, b));
        Lanes::store(k.joints.normal_x + c, n.x), Lanes::store(k.joints.normal_y + c, n.y);
        const F l = DriveRows<Lanes, Real>(k.joints, c).sum();
        a.push(l * n.x, l * n.y, F(-1)), b.push(l * n.x, l * n.y, one);
        store_velocities<Lanes>(k, c, a, b);
    }
}

/// Limits, motors and springs of angles.
template <class Lanes, bool kFirst, class Real>
[[gnu::always_inline]] inline void sweep_batch_of_angles(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    const F zero(0);
    JointSide<Lanes, true> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_rims<Lanes>(k, c, a, b);
    const F inverse = a.inverse_inertia() + b.inverse_inertia();
    F angle;
    if constexpr (kFirst) {
        angle = Lanes::load(k.joints.start_x + c) + (Lanes::gather_at(k.turn, k.joints.b + c) * b.per_rim -
                                                     Lanes::gather_at(k.turn, k.joints.a + c) * a.per_rim);
        const F off = clamp_to(DriveRows<Lanes, Real>::beyond(k, c, angle), F(k.most));
        const F by = -F(k.recovery) * off, p = simd::select(inverse > zero, by / inverse, zero);
        turn_by_displacement<Lanes>(k.turn, k.joints.a + c, a, -p);
        turn_by_displacement<Lanes>(k.turn, k.joints.b + c, b, p);
        angle += by;
        Lanes::store(k.joints.value + c, angle);
    } else {
        angle = Lanes::load(k.joints.value + c);
    }
    DriveRows<Lanes, Real> rows(k.joints, c);
    const F added = rows.solve(k, c, angle, angle, b.spin() - a.spin(), inverse);
    rows.store(k.joints, c);
    a.turn(-added), b.turn(added);
    store_velocities<Lanes>(k, c, a, b);
}

template <bool kFirst, class Real, class Isa>
void sweep_angles(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size) sweep_batch_of_angles<Lanes, kFirst>(k, c);
}

template <class Lanes, class Real>
[[gnu::always_inline]] inline void give_batch_of_angles(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    JointSide<Lanes, true> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_rims<Lanes>(k, c, a, b);
    const F l = DriveRows<Lanes, Real>(k.joints, c).sum();
    a.turn(-l), b.turn(l);
    store_velocities<Lanes>(k, c, a, b);
}

template <class Real, class Isa>
void give_angles(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size) give_batch_of_angles<Lanes>(k, c);
}

}  // namespace
}  // namespace carom

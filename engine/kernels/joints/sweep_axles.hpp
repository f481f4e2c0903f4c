#pragma once

#include "kernels/joints/sweep_drives.hpp"

// Wheels and sliders by lanes: a point of b that stays on an axis of a. The way across the axis is held;
// spring, motor and ends act on the way along it.
//
// Both bodies are pushed at b's point: as a sees it, it is a point of a's that a carries round with it, so
// that a's arm reaches from its centre to b's point (constraints/joints/prismatic_joint.hpp). The axis turns
// by f = h spin_a in a substep, across which a velocity v along the axis leads by f v: that much is asked of
// the velocity across. It is what keeps energy: the axis has turned by as much since the last substep, and
// took as much of the velocity across.

namespace carom {
namespace {

/// The axis of a batch, and what an impulse gives the velocity of b's point against a's.
template <class Lanes>
struct Axles {
    using F = typename Lanes::Batch;
    F nx, ny;                                    // no unit, along the axis; across it is (-ny, nx)
    F along_along, along_across, across_across;  // 1/kg

    void weigh(const JointSide<Lanes, true>& a, const JointSide<Lanes, true>& b) {
        const F w = a.inverse_mass() + b.inverse_mass();
        along_along = across_across = w, along_across = F(0);
        for (const JointSide<Lanes, true>* side : {&a, &b}) {
            const F inverse = side->inverse_inertia(), along = side->arm.x * nx + side->arm.y * ny,
                    across = side->arm.y * nx - side->arm.x * ny;
            along_along += inverse * across * across, across_across += inverse * along * along;
            along_across -= inverse * along * across;
        }
    }
    /// In the directions of the world.
    Pair2<F> sum(F along, F across) const { return {along * nx - across * ny, along * ny + across * nx}; }
    Pair2<F> parts_of(Pair2<F> v) const { return {v.x * nx + v.y * ny, v.y * nx - v.x * ny}; }
};

/// The axis, turned with a, and arms to b's point. @return from a's point to b's
template <class Lanes, class Real>
[[gnu::always_inline]] inline Pair2<typename Lanes::Batch> turn_axles(
    const SweepJoints<Real>& k, std::size_t c, const typename Lanes::Batch2& moved_a,
    const typename Lanes::Batch2& moved_b, JointSide<Lanes, true>& a, JointSide<Lanes, true>& b,
    Axles<Lanes>& axles) {
    using F = typename Lanes::Batch;
    turn_arms<Lanes>(k, c, a, b);
    const Pair2<F> by = rotation_of<Lanes>(Lanes::gather_at(k.turn, k.joints.a + c) * a.per_rim);
    const F x = Lanes::load(k.joints.axis_x + c), y = Lanes::load(k.joints.axis_y + c);
    axles.nx = by.x * x - by.y * y, axles.ny = by.y * x + by.x * y;
    Lanes::store(k.joints.normal_x + c, axles.nx), Lanes::store(k.joints.normal_y + c, axles.ny);
    const Pair2<F> d = between<Lanes, true>(k, c, moved_a, moved_b, a, b);
    a.arm.x += d.x, a.arm.y += d.y;
    keep_arms<Lanes>(k, c, a, b);
    return d;
}

template <bool kFirst, class Real, class Isa>
void sweep_axles(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    const F one(1), zero(0), h(k.h);
    for (std::size_t c = first; c < last; c += Lanes::size) {
        JointSide<Lanes, true> a, b;
        load_velocities<Lanes>(k, c, a, b);
        load_arms<Lanes, true>(k, c, a, b);
        DriveRows<Lanes, Real> rows(k.joints, c);
        Axles<Lanes> axles{};
        axles.nx = Lanes::load(k.joints.normal_x + c), axles.ny = Lanes::load(k.joints.normal_y + c);
        F across = Lanes::load(k.joints.across + c), way;
        Pair2<F> l = axles.sum(rows.sum(), across);
        const auto per = [&](F inverse) { return simd::select(inverse > zero, one / inverse, zero); };
        if constexpr (kFirst) {
            simd::forget_loads();
            a.push(l.x, l.y, one), b.push(l.x, l.y, F(-1));
            auto moved_a = Lanes::load_rows2(k.displacement, k.joints.a + c);
            auto moved_b = Lanes::load_rows2(k.displacement, k.joints.b + c);
            const Pair2<F> d = axles.parts_of(turn_axles<Lanes>(k, c, moved_a, moved_b, a, b, axles));
            axles.weigh(a, b);
            const F recovery = -F(k.recovery), most(k.most);
            const F by = recovery * clamp_to(DriveRows<Lanes, Real>::beyond(k, c, d.x), most),
                    by_across = recovery * clamp_to(d.y, most);
            const Pair2<F> p = axles.sum(by * per(axles.along_along), by_across * per(axles.across_across));
            displace<Lanes, true>(k, c, moved_a, moved_b, a, b, p);
            way = d.x + by;
            Lanes::store(k.joints.value + c, way);
            // Velocities have the impulses of the substep before in them, now along what the axis is now.
            l = axles.sum(rows.sum(), across);
            a.push(l.x, l.y, F(-1)), b.push(l.x, l.y, one);
        } else {
            way = Lanes::load(k.joints.value + c);
            axles.weigh(a, b);
        }
        const auto share_of = [&](const JointSide<Lanes, true>& side) {
            const F strain =
                F(4) * h * simd::abs(side.arm.x * l.x + side.arm.y * l.y) * side.own_inverse_inertia();
            return side.seen / (one + strain * strain);
        };
        const F share_a = share_of(a);
        Pair2<F> v = axles.parts_of(parting<Lanes, true>(a, b, h, share_a, share_of(b)));
        const F added_along = rows.solve(k, c, way, way, v.x, axles.along_along);
        v.x += axles.along_along * added_along, v.y += axles.along_across * added_along;
        const F led = clamp_to(h * a.spin(), constant<Lanes>(kMostBend)) * share_a * v.x;
        const F added_across = (led - v.y) * per(axles.across_across);
        rows.store(k.joints, c);
        Lanes::store(k.joints.across + c, across + added_across);
        const Pair2<F> added = axles.sum(added_along, added_across);
        a.push(added.x, added.y, F(-1)), b.push(added.x, added.y, one);
        store_velocities<Lanes>(k, c, a, b);
    }
}

/// Gives the bodies the impulses that these joints had at the end of the step before.
template <class Real, class Isa>
void give_axles(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size) {
        JointSide<Lanes, true> a, b;
        load_velocities<Lanes>(k, c, a, b);
        load_arms<Lanes, true>(k, c, a, b);
        const typename Lanes::Batch2 still{{F(0), F(0)}};
        Axles<Lanes> axles{};
        turn_axles<Lanes>(k, c, still, still, a, b, axles);
        const Pair2<F> l =
            axles.sum(DriveRows<Lanes, Real>(k.joints, c).sum(), Lanes::load(k.joints.across + c));
        a.push(l.x, l.y, F(-1)), b.push(l.x, l.y, F(1));
        store_velocities<Lanes>(k, c, a, b);
    }
}

}  // namespace
}  // namespace carom

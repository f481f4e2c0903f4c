#pragma once

#include <cstdint>
#include <limits>
#include <numbers>

#include "kernels/joints/joint_arguments.hpp"
#include "simd/forget_loads.hpp"
#include "simd/lanes.hpp"
#include "simd/ordered_lanes.hpp"

// Rods and hinges by lanes. An impulse j at an arm r turns a body by r × j / I; with the rim = sqrt(2 I / m)
// and the rim speed u = spin * rim that is a change of u by 2 w (r / rim) × j: effects/contact_law.hpp.
//
// The rows are curved, as those of constraints/joints/joint_system.hpp: a rod of length d whose ends pass
// each other at v_t would grow to sqrt(d² + h² v_t²) in a substep along the tangent, so it asks for v_n = -h
// v_t² / 2d; an arm that turns by f = h spin bends off its tangent by (cos f - 1) r + (sin f - f) r⊥. The
// bend is found at each visit: one that was kept loses energy. Where a joint pulls a body harder than its
// inertia bears in a substep the bend is divided by 1 + (16 s)², s = h |l| (w_a + w_b) / 4d, or rows that
// converge explode. What joints pull at a body's arms in the step before may turn it faster than a substep
// can follow: then they see more inertia than it has, h² times that stiffness. docs/decisions/0026-joints.md.

namespace carom {
namespace {

template <class Lanes>
typename Lanes::Batch constant(double value) {
    return typename Lanes::Batch(static_cast<typename Lanes::Number>(value));
}

/// rad, of a substep: the bend of less is below the rounding of any velocity.
constexpr double kLeastBentTurn = 1e-12;

template <class F>
struct Pair2 {
    F x, y;
};

/// cos f - 1 and sin f - f over h, for what a substep turns; beyond kMostBend they grow no faster than the
/// turn: the series would make of a fast spin a bend, and the bend of a faster one, without end. Below
/// kLeastBentTurn there is none: its products would be too small for normal numbers.
template <class Lanes, class F = typename Lanes::Batch>
Pair2<F> bend_of_turn(F spin, F h) {
    constexpr auto number = constant<Lanes>;
    const F turn = simd::max(simd::min(spin * h, number(kMostBend)), number(-kMostBend)),
            f = simd::select(simd::abs(turn) < number(kLeastBentTurn), F(0), turn), q = f * f,
            c2 = number(-0.5), c4 = number(1.0 / 24), s3 = number(-1.0 / 6), s5 = number(1.0 / 120);
    return {spin * f * (c2 + c4 * q), spin * q * (s3 + s5 * q)};
}

/// What a rod grows by in a substep, over h, where its ends pass each other, were they to go straight on;
/// beyond kMostBend likewise.
/// @param across  m/s, velocity of its ends across it  @param half_h  s
template <class Lanes, class F = typename Lanes::Batch>
[[gnu::always_inline]] inline F growth_of_turn(F across, F half_h, F per_length) {
    return simd::min(half_h * across * across * per_length,
                     constant<Lanes>(0.5 * kMostBend) * simd::abs(across));
}

/// The same direction within half a turn, as far as the precision tells; beyond kMostTurn all are one.
template <class Lanes, class F = typename Lanes::Batch>
F within_half_turn(F angle) {
    constexpr auto number = constant<Lanes>;
    constexpr double kMostTurn = 1e6, kTurn = 2 * std::numbers::pi;  // rad
    // 1.5 times the number from which on there are no fractions: what is added to it is rounded.
    constexpr double kNoFraction =
        1.5 *
        static_cast<double>(std::uint64_t{1} << (std::numeric_limits<typename Lanes::Number>::digits - 1));
    const F f = simd::max(simd::min(angle, number(kMostTurn)), number(-kMostTurn));
    const F turns = (f * number(1 / kTurn) + number(kNoFraction)) - number(kNoFraction);
    return f - turns * number(kTurn);
}

/// cos and sin of the turn since the start of the step: by series of half of it, doubled, which are exact to
/// 1e-6 up to half a turn. Beyond that they would make arms longer, by any factor.
template <class Lanes, class F = typename Lanes::Batch>
Pair2<F> rotation_of(F angle) {
    constexpr auto number = constant<Lanes>;
    const F f = within_half_turn<Lanes>(angle) * number(0.5), q = f * f, one(1);
    const F c = one - q * number(0.5) *
                          (one - q * number(1.0 / 12) *
                                     (one - q * number(1.0 / 30) *
                                                (one - q * number(1.0 / 56) * (one - q * number(1.0 / 90)))));
    const F s = f * (one - q * number(1.0 / 6) *
                               (one - q * number(1.0 / 20) *
                                          (one - q * number(1.0 / 42) * (one - q * number(1.0 / 72)))));
    return {one - F(2) * s * s, F(2) * s * c};
}

/// A body of a batch of joints.
template <class Lanes, bool kArms>
struct JointSide {
    using F = typename Lanes::Batch;
    typename Lanes::Batch4 record;
    Pair2<F> arm{};  // m
    F per_rim{};     // 1/m
    F seen{};        // no unit, inertia over that which the substep sees

    F inverse_mass() const { return simd::abs(record[3]); }
    /// 1 / inertia, zero for what has a fixed angle.
    F own_inverse_inertia() const {
        const F turning = simd::max(record[3], F(0));
        return (turning + turning) * per_rim * per_rim;
    }
    /// The same of the inertia that the substep sees.
    F inverse_inertia() const { return own_inverse_inertia() * seen; }
    F spin() const { return record[2] * per_rim; }
    Pair2<F> anchor_velocity() const {
        if constexpr (!kArms) return {record[0], record[1]};
        const F s = spin();
        return {record[0] - s * arm.y, record[1] + s * arm.x};
    }
    /// @param sign  1 as b, -1 as a
    void push(F jx, F jy, F sign) {
        const F w = inverse_mass() * sign;
        record[0] += w * jx, record[1] += w * jy;
        if constexpr (kArms) turn(sign * (arm.x * jy - arm.y * jx));
    }
    void turn(F torque) {
        const F turning = simd::max(record[3], F(0));
        record[2] += (turning + turning) * per_rim * seen * torque;
    }
};

/// What the anchors of two bodies move apart by in a substep, over h, bend of their arms included.
template <class Lanes, bool kArms>
Pair2<typename Lanes::Batch> parting(const JointSide<Lanes, kArms>& a, const JointSide<Lanes, kArms>& b,
                                     typename Lanes::Batch h, typename Lanes::Batch share_a,
                                     typename Lanes::Batch share_b) {
    using F = typename Lanes::Batch;
    const Pair2<F> va = a.anchor_velocity(), vb = b.anchor_velocity();
    Pair2<F> v{vb.x - va.x, vb.y - va.y};
    if constexpr (kArms) {
        const Pair2<F> ta = bend_of_turn<Lanes>(a.spin(), h), tb = bend_of_turn<Lanes>(b.spin(), h);
        v.x += share_b * (tb.x * b.arm.x - tb.y * b.arm.y) - share_a * (ta.x * a.arm.x - ta.y * a.arm.y);
        v.y += share_b * (tb.x * b.arm.y + tb.y * b.arm.x) - share_a * (ta.x * a.arm.y + ta.y * a.arm.x);
    }
    return v;
}

template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline void load_velocities(const SweepJoints<Real>& k, std::size_t c,
                                                   JointSide<Lanes, kArms>& a, JointSide<Lanes, kArms>& b) {
    simd::load_both4<Lanes>(k.velocity, k.joints.a + c, k.joints.b + c, a.record, b.record);
}

template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline void store_velocities(const SweepJoints<Real>& k, std::size_t c,
                                                    const JointSide<Lanes, kArms>& a,
                                                    const JointSide<Lanes, kArms>& b) {
    simd::store_both4<Lanes>(k.velocity, k.joints.a + c, k.joints.b + c, a.record, b.record);
}

template <class Lanes, class Real>
[[gnu::always_inline]] inline void load_displacements(const SweepJoints<Real>& k, std::size_t c,
                                                      typename Lanes::Batch2& a, typename Lanes::Batch2& b) {
    simd::load_both2<Lanes>(k.displacement, k.joints.a + c, k.joints.b + c, a, b);
}

template <class Lanes, class Real>
[[gnu::always_inline]] inline void load_rims(const SweepJoints<Real>& k, std::size_t c,
                                             JointSide<Lanes, true>& a, JointSide<Lanes, true>& b) {
    a.per_rim = Lanes::load(k.joints.per_rim_a + c), b.per_rim = Lanes::load(k.joints.per_rim_b + c);
    a.seen = Lanes::load(k.joints.seen_a + c), b.seen = Lanes::load(k.joints.seen_b + c);
}

template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline void load_arms(const SweepJoints<Real>& k, std::size_t c,
                                             JointSide<Lanes, kArms>& a, JointSide<Lanes, kArms>& b) {
    if constexpr (kArms) {
        a.arm = {Lanes::load(k.joints.arm_a_x + c), Lanes::load(k.joints.arm_a_y + c)};
        b.arm = {Lanes::load(k.joints.arm_b_x + c), Lanes::load(k.joints.arm_b_y + c)};
        load_rims<Lanes>(k, c, a, b);
    }
}

/// Arms where the bodies have turned to by now.
template <class Lanes, class Real>
[[gnu::always_inline]] inline void turn_arms(const SweepJoints<Real>& k, std::size_t c,
                                             JointSide<Lanes, true>& a, JointSide<Lanes, true>& b) {
    using F = typename Lanes::Batch;
    const auto turned = [&](const std::int32_t* rows, F per_rim, const Real* x, const Real* y) {
        const Pair2<F> by = rotation_of<Lanes>(Lanes::gather_at(k.turn, rows) * per_rim);
        const F ax = Lanes::load(x + c), ay = Lanes::load(y + c);
        return Pair2<F>{by.x * ax - by.y * ay, by.y * ax + by.x * ay};
    };
    a.arm = turned(k.joints.a + c, a.per_rim, k.joints.start_arm_a_x, k.joints.start_arm_a_y);
    b.arm = turned(k.joints.b + c, b.per_rim, k.joints.start_arm_b_x, k.joints.start_arm_b_y);
}

/// Those that the sweeps of a substep act at, and its books.
template <class Lanes, class Real>
[[gnu::always_inline]] inline void keep_arms(const SweepJoints<Real>& k, std::size_t c,
                                             const JointSide<Lanes, true>& a,
                                             const JointSide<Lanes, true>& b) {
    Lanes::store(k.joints.arm_a_x + c, a.arm.x), Lanes::store(k.joints.arm_a_y + c, a.arm.y);
    Lanes::store(k.joints.arm_b_x + c, b.arm.x), Lanes::store(k.joints.arm_b_y + c, b.arm.y);
}

/// From a's anchor to b's.
template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline Pair2<typename Lanes::Batch> between(const SweepJoints<Real>& k, std::size_t c,
                                                                   const typename Lanes::Batch2& moved_a,
                                                                   const typename Lanes::Batch2& moved_b,
                                                                   const JointSide<Lanes, kArms>& a,
                                                                   const JointSide<Lanes, kArms>& b) {
    using F = typename Lanes::Batch;
    Pair2<F> d{Lanes::load(k.joints.start_x + c) + (moved_b[0] - moved_a[0]),
               Lanes::load(k.joints.start_y + c) + (moved_b[1] - moved_a[1])};
    if constexpr (kArms) d.x += b.arm.x - a.arm.x, d.y += b.arm.y - a.arm.y;
    return d;
}

/// Direction and length of what joins two anchors.
template <class F>
struct Direction {
    F x, y, length, per_length;  ///< no unit; m; 1/m. (1, 0) and zero per length where there is no length
};

template <class Lanes, class F = typename Lanes::Batch>
[[gnu::always_inline]] inline Direction<F> direction_of(Pair2<F> d) {
    const F one(1), zero(0);
    const F length = simd::sqrt(d.x * d.x + d.y * d.y);
    const auto has_length = length > zero;
    const F per_length = simd::select(has_length, one / length, zero);
    return {simd::select(has_length, d.x * per_length, one), d.y * per_length, length, per_length};
}

/// The inverse mass of both bodies for an impulse along (nx, ny) [1/kg].
template <class Lanes, bool kArms, class F = typename Lanes::Batch>
[[gnu::always_inline]] inline F inverse_mass_along(const JointSide<Lanes, kArms>& a,
                                                   const JointSide<Lanes, kArms>& b, F nx, F ny) {
    F inverse = a.inverse_mass() + b.inverse_mass();
    if constexpr (kArms) {
        const F ca = a.arm.x * ny - a.arm.y * nx, cb = b.arm.x * ny - b.arm.y * nx;
        inverse += a.inverse_inertia() * ca * ca + b.inverse_inertia() * cb * cb;
    }
    return inverse;
}

/// Turns the bodies of a batch by an angular impulse of displacement [kg m²].
template <class Lanes, class Real, bool kArms>
[[gnu::always_inline]] inline void turn_by_displacement(Real* turn, const std::int32_t* rows,
                                                        const JointSide<Lanes, kArms>& side,
                                                        typename Lanes::Batch torque) {
    using F = typename Lanes::Batch;
    const F turning = simd::max(side.record[3], F(0)),
            added = (turning + turning) * side.per_rim * side.seen * torque;
    if constexpr (requires { &Lanes::add_at; }) return Lanes::add_at(turn, rows, added);
    alignas(64) Real numbers[Lanes::size];
    Lanes::store(numbers, added);
    for (std::size_t lane = 0; lane < Lanes::size; ++lane)
        if (numbers[lane] != Real(0)) turn[rows[lane]] += numbers[lane];
}

/// Displaces the bodies by an impulse (px, py) [kg m] on b, and the other way on a.
template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline void displace(const SweepJoints<Real>& k, std::size_t c,
                                            typename Lanes::Batch2& moved_a, typename Lanes::Batch2& moved_b,
                                            const JointSide<Lanes, kArms>& a,
                                            const JointSide<Lanes, kArms>& b,
                                            Pair2<typename Lanes::Batch> p) {
    using F = typename Lanes::Batch;
    const F wa = a.inverse_mass(), wb = b.inverse_mass();
    moved_a[0] -= wa * p.x, moved_a[1] -= wa * p.y;
    moved_b[0] += wb * p.x, moved_b[1] += wb * p.y;
    simd::store_both2<Lanes>(k.displacement, k.joints.a + c, k.joints.b + c, moved_a, moved_b);
    if constexpr (kArms) {
        const auto moment = [&](const JointSide<Lanes, kArms>& side, F sign) {
            return sign * (side.arm.x * p.y - side.arm.y * p.x);
        };
        turn_by_displacement<Lanes>(k.turn, k.joints.a + c, a, moment(a, F(-1)));
        turn_by_displacement<Lanes>(k.turn, k.joints.b + c, b, moment(b, F(1)));
    }
}

/// Calls batch(lanes, c) for each batch of joints, with the lanes that suit how its rows lie.
template <class Real, class Isa, class Fn>
[[gnu::always_inline]] inline void for_each_batch(const SweepJoints<Real>& k, std::size_t first,
                                                  std::size_t last, const Fn& batch) {
    using Lanes = simd::Lanes<Real, Isa>;
    if constexpr (requires { &Lanes::load_pairs4; }) {
        for (std::size_t c = first; c < last;) {
            const RowOrder order = k.joints.order[c / kJointBlock];
            std::size_t end = c + kJointBlock;  // of those in a row that lie alike
            while (end < last && k.joints.order[end / kJointBlock] == order) end += kJointBlock;
            if (order == RowOrder::runs)
                for (; c < end; c += Lanes::size) batch(simd::LanesOfRuns<Lanes>{}, c);
            else if (order == RowOrder::pairs)
                for (; c < end; c += Lanes::size) batch(simd::LanesOfPairs<Lanes>{}, c);
            else
                for (; c < end; c += Lanes::size) batch(Lanes{}, c);
        }
    } else {
        for (std::size_t c = first; c < last; c += Lanes::size) batch(Lanes{}, c);
    }
}

template <class F>
F clamp_to(F value, F most) {
    return simd::max(simd::min(value, most), -most);
}

/// Rods. kFirst: the first sweep of a substep, which finds directions anew and corrects lengths.
template <class Lanes, bool kArms, bool kFirst, class Real>
[[gnu::always_inline]] inline void sweep_batch_of_rods(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    const F one(1), zero(0), h(k.h), half_h(k.half_h);
    JointSide<Lanes, kArms> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_arms<Lanes, kArms>(k, c, a, b);
    const F wa = a.inverse_mass(), wb = b.inverse_mass();
    const F l = Lanes::load(k.joints.impulse_x + c);
    F nx, ny, per_length, inverse;
    if constexpr (!kFirst) {
        nx = Lanes::load(k.joints.normal_x + c), ny = Lanes::load(k.joints.normal_y + c);
        per_length = Lanes::load(k.joints.per_length + c);
        inverse = inverse_mass_along<Lanes, kArms>(a, b, nx, ny);
    } else {
        simd::forget_loads();
        const F old_x = l * Lanes::load(k.joints.normal_x + c),
                old_y = l * Lanes::load(k.joints.normal_y + c);
        F torque_a = zero, torque_b = zero;
        if constexpr (kArms) {
            torque_a = a.arm.x * old_y - a.arm.y * old_x, torque_b = b.arm.x * old_y - b.arm.y * old_x;
            turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
        }
        typename Lanes::Batch2 moved_a, moved_b;
        load_displacements<Lanes>(k, c, moved_a, moved_b);
        const auto now = direction_of<Lanes>(between<Lanes, kArms>(k, c, moved_a, moved_b, a, b));
        nx = now.x, ny = now.y, per_length = now.per_length;
        Lanes::store(k.joints.normal_x + c, nx), Lanes::store(k.joints.normal_y + c, ny);
        Lanes::store(k.joints.per_length + c, per_length);
        inverse = inverse_mass_along<Lanes, kArms>(a, b, nx, ny);
        const F length = Lanes::load(k.joints.length + c);
        const F off = clamp_to(now.length - length, F(k.most) * length);
        const F p = simd::select(inverse > zero, -F(k.recovery) * off / inverse, zero);
        displace<Lanes, kArms>(k, c, moved_a, moved_b, a, b, {p * nx, p * ny});
        // Velocities have the impulses of the substep before in them (advance_bodies.hpp): turned to what
        // the rod is now.
        a.record[0] -= wa * (l * nx - old_x), a.record[1] -= wa * (l * ny - old_y);
        b.record[0] += wb * (l * nx - old_x), b.record[1] += wb * (l * ny - old_y);
        if constexpr (kArms) {
            a.turn(torque_a - (a.arm.x * (l * ny) - a.arm.y * (l * nx)));
            b.turn((b.arm.x * (l * ny) - b.arm.y * (l * nx)) - torque_b);
        }
    }
    const F strain = F(4) * h * simd::abs(l) * inverse * per_length;
    const F share = one / (one + strain * strain);
    const Pair2<F> v = parting<Lanes, kArms>(a, b, h, share, share);
    const F along = v.x * nx + v.y * ny, across = v.y * nx - v.x * ny;
    const F wanted = -growth_of_turn<Lanes>(across, half_h, per_length) * share;
    const F added = simd::select(inverse > zero, F(k.over_relaxation) * (wanted - along) / inverse, zero);
    Lanes::store(k.joints.impulse_x + c, l + added);
    a.push(added * nx, added * ny, F(-1)), b.push(added * nx, added * ny, one);
    store_velocities<Lanes>(k, c, a, b);
}

template <bool kArms, bool kFirst, class Real, class Isa>
void sweep_rods(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for_each_batch<Real, Isa>(
        k, first, last, [&]<class Lanes>(Lanes, std::size_t c) __attribute__((always_inline)) {
            sweep_batch_of_rods<Lanes, kArms, kFirst>(k, c);
        });
}

/// Hinges.
template <class Lanes, bool kFirst, class Real>
[[gnu::always_inline]] inline void sweep_batch_of_hinges(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    const F one(1), zero(0), h(k.h);
    JointSide<Lanes, true> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_arms<Lanes, true>(k, c, a, b);
    F lx = Lanes::load(k.joints.impulse_x + c), ly = Lanes::load(k.joints.impulse_y + c);
    F torque_a = zero, torque_b = zero;
    if constexpr (kFirst) {
        torque_a = a.arm.x * ly - a.arm.y * lx, torque_b = b.arm.x * ly - b.arm.y * lx;
        turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
    }
    // The inverse mass at the anchor, 2 × 2, and its inverse.
    const F ia = a.inverse_inertia(), ib = b.inverse_inertia(), w = a.inverse_mass() + b.inverse_mass();
    const F xx = w + ia * a.arm.y * a.arm.y + ib * b.arm.y * b.arm.y,
            xy = -(ia * a.arm.x * a.arm.y + ib * b.arm.x * b.arm.y),
            yy = w + ia * a.arm.x * a.arm.x + ib * b.arm.x * b.arm.x;
    const F determinant = xx * yy - xy * xy;
    const F per = simd::select(determinant > zero, one / determinant, zero);
    const auto solve = [&](F x, F y) { return Pair2<F>{per * (yy * x - xy * y), per * (xx * y - xy * x)}; };
    if constexpr (kFirst) {
        simd::forget_loads();
        auto moved_a = Lanes::load_rows2(k.displacement, k.joints.a + c);
        auto moved_b = Lanes::load_rows2(k.displacement, k.joints.b + c);
        const Pair2<F> d = between<Lanes, true>(k, c, moved_a, moved_b, a, b);
        const F most(k.most), recovery = -F(k.recovery);
        displace<Lanes, true>(k, c, moved_a, moved_b, a, b,
                              solve(recovery * clamp_to(d.x, most), recovery * clamp_to(d.y, most)));
        a.turn(torque_a - (a.arm.x * ly - a.arm.y * lx));
        b.turn((b.arm.x * ly - b.arm.y * lx) - torque_b);
    }
    const auto share_of = [&](const JointSide<Lanes, true>& side) {
        const F strain = F(4) * h * simd::abs(side.arm.x * lx + side.arm.y * ly) * side.own_inverse_inertia();
        return side.seen / (one + strain * strain);
    };
    const Pair2<F> v = parting<Lanes, true>(a, b, h, share_of(a), share_of(b));
    const F relax = -F(k.over_relaxation);
    const Pair2<F> added = solve(relax * v.x, relax * v.y);
    Lanes::store(k.joints.impulse_x + c, lx + added.x), Lanes::store(k.joints.impulse_y + c, ly + added.y);
    a.push(added.x, added.y, F(-1)), b.push(added.x, added.y, one);
    store_velocities<Lanes>(k, c, a, b);
}

template <bool kFirst, class Real, class Isa>
void sweep_hinges(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size) sweep_batch_of_hinges<Lanes, kFirst>(k, c);
}

/// Gives the bodies of rods the impulses that these had at the end of the step before, along what they are
/// now.
template <class Lanes, bool kArms, class Real>
[[gnu::always_inline]] inline void give_batch_of_rods(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    const F one(1), zero(0);
    JointSide<Lanes, kArms> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_arms<Lanes, kArms>(k, c, a, b);
    if constexpr (kArms) turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
    const typename Lanes::Batch2 still{{zero, zero}};
    const auto n = direction_of<Lanes>(between<Lanes, kArms>(k, c, still, still, a, b));
    Lanes::store(k.joints.normal_x + c, n.x), Lanes::store(k.joints.normal_y + c, n.y);
    const F l = Lanes::load(k.joints.impulse_x + c);
    a.push(l * n.x, l * n.y, F(-1)), b.push(l * n.x, l * n.y, one);
    store_velocities<Lanes>(k, c, a, b);
}

template <bool kArms, class Real, class Isa>
void give_rods(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for_each_batch<Real, Isa>(
        k, first, last, [&]<class Lanes>(Lanes, std::size_t c) __attribute__((always_inline)) {
            give_batch_of_rods<Lanes, kArms>(k, c);
        });
}

/// Likewise of hinges.
template <class Lanes, class Real>
[[gnu::always_inline]] inline void give_batch_of_hinges(const SweepJoints<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    JointSide<Lanes, true> a, b;
    load_velocities<Lanes>(k, c, a, b);
    load_arms<Lanes, true>(k, c, a, b);
    turn_arms<Lanes>(k, c, a, b), keep_arms<Lanes>(k, c, a, b);
    const F lx = Lanes::load(k.joints.impulse_x + c), ly = Lanes::load(k.joints.impulse_y + c);
    a.push(lx, ly, F(-1)), b.push(lx, ly, F(1));
    store_velocities<Lanes>(k, c, a, b);
}

template <class Real, class Isa>
void give_hinges(const SweepJoints<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SweepJoints<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size) give_batch_of_hinges<Lanes>(k, c);
}

}  // namespace
}  // namespace carom

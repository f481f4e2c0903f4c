#pragma once

#include "simd/scalar_lanes.hpp"

// What a contact does, each formula once: over the lanes of a sweep and over one contact in double precision,
// and whether the other side of the contact moves or not. Whatever solves contacts, judges how well they are
// solved or books their work takes its formulas from here.
//
// The normal n points from body a to the other side b, the tangent t is n turned by a quarter
// counter-clockwise; impulses act on b, minus on a. A body's record is [4]: vx, vy [m/s], rim speed
// u = spin * rim [m/s], inverse mass w [1/kg] with a sign. The rim is sqrt(2 I / m), for a disc its radius:
// an impulse j [N s] at the rim changes u by rim² j / I = 2 w j, so no formula needs a radius or an inertia.
//
//   normal velocity      v_n = (v_b - v_a) · n
//   tangential velocity  v_t = (v_b - v_a) · t - u_a - u_b          of the surfaces
//   rolling velocity     v_r = (1 - s) u_b - s u_a                  effects/rolling_resistance.hpp has s
//   effective mass       1 / (w_a + w_b), 1 / (3 (w_a + w_b)), 1 / (2 s² w_a + 2 (1 - s)² w_b)
//
//   Signorini  the normal impulse pushes, and v_n ends at `floor` or above, at `floor` where it pushes
//   Coulomb    the tangential impulse stops v_t, but is at most friction times the normal impulse
//   rolling    the rolling impulse stops v_r, but is at most its coefficient times the normal impulse
//
// A normal impulse of a disc changes neither v_t nor v_r, so that the normal law does not wait for the
// others.
// Functions have internal linkage: kernels are compiled once for each instruction set.

namespace carom {

/// What a variant of the contact law has compiled in.
enum ContactVariant : unsigned {
    kRough = 1,        // friction, and with it rotation
    kFixedAngles = 2,  // some bodies do not turn
    kRolling = 4,      // rolling resistance (only with kRough): effects/rolling_resistance.hpp
};

/// Impulses of a contact [N s], or what is added to them.
template <class F>
struct ContactImpulses {
    F normal, tangent, rolling;
};

/// What decides the impulses of a contact.
template <class F>
struct ContactTerms {
    F nx, ny;
    F mass, tangent_mass;  // kg, effective
    F floor;               // m/s, least normal velocity
    F friction, rolling;   // coefficients
    F of_a;                // the share s of body a's rim speed in the rolling velocity
};

/// An impulse, and what was added to it.
template <class F>
struct ImpulseUpdate {
    F impulse, added;
};

namespace {

/// Effective mass along the tangent in shares of that along the normal, where both bodies turn: an impulse
/// changes v_t by w at the centre of a body and by 2 w at its rim.
inline constexpr double kTangentMassShare = 1.0 / 3;

/// A body of a contact, a lane a contact.
template <unsigned kVariant, class Lanes>
struct MovingSide {
    static constexpr bool kMoves = true;
    using F = typename Lanes::Batch;
    using Number = typename Lanes::Number;
    typename Lanes::Batch4 record;

    /// w of a record: zero for what nothing moves, negative for what has a fixed angle.
    F inverse_mass() const {
        using simd::abs;
        if constexpr ((kVariant & kFixedAngles) != 0) return abs(record[3]);
        return record[3];
    }
    /// rim² / I = 2 w: what an impulse at the rim changes the rim speed by; zero for what has a fixed angle.
    F inverse_rim_mass() const {
        using simd::max;
        if constexpr ((kVariant & kFixedAngles) != 0) {
            const F turning = max(record[3], F(0));
            return turning + turning;
        }
        return record[3] + record[3];
    }
    /// @param sign  1 as b of its contact, -1 as a; the arm of a tangential impulse has the same sign for
    /// both (docs/conventions.md): one on b along t slows both rims.
    void apply_impulse(F normal, F tangent, F nx, F ny, F sign) {
        const F w = inverse_mass() * sign;
        if constexpr ((kVariant & kRough) != 0) {
            record[0] += w * (normal * nx - tangent * ny);
            record[1] += w * (normal * ny + tangent * nx);
            record[2] -= inverse_rim_mass() * tangent;
        } else {
            record[0] += w * (normal * nx);
            record[1] += w * (normal * ny);
        }
    }
};

/// The other side of a contact that nothing moves: a surface with a steady velocity [m/s].
template <class Lanes>
struct SteadySide {
    static constexpr bool kMoves = false;
    using F = typename Lanes::Batch;
    F normal;   // along n
    F tangent;  // of the surface, along t
    F rolling;  // its part of the rolling velocity

    void apply_impulse(F, F, F, F, F) const {}
};

/// v_n. @param b  a MovingSide or a SteadySide, here and below
template <class A, class B, class F>
F normal_velocity(const A& a, const B& b, F nx, F ny) {
    if constexpr (B::kMoves)
        return (b.record[0] - a.record[0]) * nx + (b.record[1] - a.record[1]) * ny;
    else
        return b.normal - (a.record[0] * nx + a.record[1] * ny);
}

/// v_t
template <class A, class B, class F>
F tangent_velocity(const A& a, const B& b, F nx, F ny) {
    if constexpr (B::kMoves)
        return (b.record[1] - a.record[1]) * nx - (b.record[0] - a.record[0]) * ny - a.record[2] -
               b.record[2];
    else
        return b.tangent - (a.record[1] * nx - a.record[0] * ny) - a.record[2];
}

/// v_r. @param of_a  the share s of body a's rim speed
template <class A, class B, class F>
F rolling_velocity(const A& a, const B& b, F of_a) {
    if constexpr (B::kMoves)
        return (F(1) - of_a) * b.record[2] - of_a * a.record[2];
    else
        return b.rolling - of_a * a.record[2];
}

/// What a normal impulse changes v_n by [1/kg].
template <class A, class B>
typename A::F inverse_mass(const A& a, const B& b) {
    if constexpr (B::kMoves)
        return a.inverse_mass() + b.inverse_mass();
    else
        return a.inverse_mass();
}

/// What a tangential impulse changes v_t by [1/kg].
template <class A, class B>
typename A::F inverse_tangent_mass(const A& a, const B& b) {
    if constexpr (B::kMoves)
        return inverse_mass(a, b) + a.inverse_rim_mass() + b.inverse_rim_mass();
    else
        return inverse_mass(a, b) + a.inverse_rim_mass();
}

/// @param mass  along the normal [kg]; zero for padding, which has no tangential mass either
template <unsigned kVariant, class A, class B, class F>
F tangent_mass(const A& a, const B& b, F mass) {
    using simd::select;
    if constexpr ((kVariant & kRough) == 0)
        return F(0);
    else if constexpr ((kVariant & kFixedAngles) != 0)
        return select(mass > F(0), F(1) / inverse_tangent_mass(a, b), F(0));
    else
        return mass * F(static_cast<typename A::Number>(kTangentMassShare));
}

/// Signorini. @param wanted  the impulse that would bring this contact alone to its floor
template <class F>
ImpulseUpdate<F> push_only(F before, F wanted) {
    using simd::max;
    const F impulse = max(wanted, F(0));
    return {impulse, impulse - before};
}

/// Coulomb, of sliding and of rolling alike. @param wanted  the impulse that would stop the motion
template <class F>
ImpulseUpdate<F> hold_within(F before, F wanted, F limit) {
    using simd::max;
    using simd::min;
    const F impulse = max(min(wanted, limit), -limit);
    return {impulse, impulse - before};
}

/// What an impulse along the rolling velocity changes the rims by.
template <class A, class B, class F>
[[gnu::always_inline]] inline void apply_rolling(A& a, B& b, F of_a, F rolling) {
    a.record[2] -= of_a * a.inverse_rim_mass() * rolling;
    if constexpr (B::kMoves) b.record[2] += (F(1) - of_a) * b.inverse_rim_mass() * rolling;
}

/// The impulses of a contact on its sides.
template <unsigned kVariant, class A, class B, class F>
[[gnu::always_inline]] inline void apply_impulses(A& a, B& b, F nx, F ny, F of_a,
                                                  const ContactImpulses<F>& impulses) {
    a.apply_impulse(impulses.normal, impulses.tangent, nx, ny, F(-1));
    b.apply_impulse(impulses.normal, impulses.tangent, nx, ny, F(1));
    if constexpr ((kVariant & kRolling) != 0) apply_rolling(a, b, of_a, impulses.rolling);
}

/// The rolling impulse for a normal impulse, and what was added to it, which both rims get.
/// @param slip  v_t; out: with what the rims changed it by
template <class A, class B, class F>
[[gnu::always_inline]] inline ImpulseUpdate<F> solve_rolling(A& a, B& b, const ContactTerms<F>& c, F before,
                                                             F normal, F& slip) {
    using simd::select;
    const F by_a = c.of_a * a.inverse_rim_mass();
    F change_of_slip = by_a, inverse_mass = c.of_a * by_a;
    if constexpr (B::kMoves) {
        const F of_b = F(1) - c.of_a, by_b = of_b * b.inverse_rim_mass();
        change_of_slip = by_a - by_b, inverse_mass = c.of_a * by_a + of_b * by_b;
    }
    // Zero if neither body turns.
    const F mass = select(inverse_mass > F(0), F(1) / inverse_mass, F(0));
    const auto roll = hold_within(before, before - mass * rolling_velocity(a, b, c.of_a), c.rolling * normal);
    apply_rolling(a, b, c.of_a, roll.added);
    slip += change_of_slip * roll.added;
    return roll;
}

/// One contact on its own, as Gauss-Seidel wants it: its impulses for the velocities of now, given to its
/// sides.
/// @param relax  what is done of the change of a normal impulse that this contact alone would want: over-
/// relaxed (Young 1950) it goes farther, since the next contact will push back
/// @return what was added to the impulses
template <unsigned kVariant, class A, class B, class F, class Relax>
[[gnu::always_inline]] inline ContactImpulses<F> solve_contact(A& a, B& b, const ContactTerms<F>& c,
                                                               ContactImpulses<F>& impulses,
                                                               const Relax& relax) {
    ContactImpulses<F> added{F(0), F(0), F(0)};
    F slip(0);
    if constexpr ((kVariant & kRough) != 0) slip = tangent_velocity(a, b, c.nx, c.ny);
    const auto normal = push_only(
        impulses.normal, impulses.normal + relax(c.mass * (c.floor - normal_velocity(a, b, c.nx, c.ny))));
    impulses.normal = normal.impulse, added.normal = normal.added;
    if constexpr ((kVariant & kRolling) != 0) {
        const auto roll = solve_rolling(a, b, c, impulses.rolling, normal.impulse, slip);
        impulses.rolling = roll.impulse, added.rolling = roll.added;
    }
    if constexpr ((kVariant & kRough) != 0) {
        const auto tangent = hold_within(impulses.tangent, impulses.tangent - c.tangent_mass * slip,
                                         c.friction * normal.impulse);
        impulses.tangent = tangent.impulse, added.tangent = tangent.added;
    }
    a.apply_impulse(added.normal, added.tangent, c.nx, c.ny, F(-1));
    b.apply_impulse(added.normal, added.tangent, c.nx, c.ny, F(1));
    return added;
}

// One contact in double precision, whatever effects are on and whichever bodies turn.
inline constexpr unsigned kEveryEffect = kRough | kFixedAngles | kRolling;
using DoubleLanes = simd::Lanes<double, simd::Scalar>;
using DoubleBody = MovingSide<kEveryEffect, DoubleLanes>;
using DoubleSurface = SteadySide<DoubleLanes>;

/// @param records  velocity records of all rows
template <class Records>
DoubleBody body_at(const Records& records, std::int32_t row) {
    const auto value = [&](std::size_t k) {
        return static_cast<double>(records[4 * static_cast<std::size_t>(row) + k]);
    };
    return {{{value(0), value(1), value(2), value(3)}}};
}

}  // namespace
}  // namespace carom

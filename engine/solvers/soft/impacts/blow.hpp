#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "effects/contact_law.hpp"
#include "effects/restitution.hpp"
#include "math/vec2_math.hpp"
#include "solvers/soft/impacts/held_impacts.hpp"
#include "solvers/soft/impacts/impact_paths.hpp"

// The impact of two discs, or of one with what supports it, at a time in a substep.

namespace carom {

/// Discs that meet.
struct StruckDiscs {
    std::int32_t a, b;  // rows; kNothing for b: what supports a
    double time;        // s, in the substep
};

/// What an impact did.
struct Blow {
    ContactImpulses<double> impulses{0, 0, 0};
    double by_normal = 0, by_friction = 0;  // J, the work of the normal impulse, and of the others
    double gravity_work = 0;                // J, on what velocities changed by, until their records' time
    Vec2 by_joints;                         // N s, on the bodies
};

/// What stands still.
inline constexpr DoubleBody kStillBody{{{0, 0, 0, 0}}};

inline DoubleBody body_of(const std::array<double, 4>& record) {
    return {{{record[0], record[1], record[2], record[3]}}};
}

/// Velocities of a contact's surfaces: normal, tangential, rolling [m/s].
template <class Side>
std::array<double, 3> velocities(const DoubleBody& a, const Side& side, const ContactTerms<double>& terms) {
    return {normal_velocity(a, side, terms.nx, terms.ny), tangent_velocity(a, side, terms.nx, terms.ny),
            rolling_velocity(a, side, terms.of_a)};
}

/// Carries out the impact of discs that fly.
/// @param terms  of the contact: direction, materials, least normal velocity afterwards
/// @param a, side  the sides, in and out
template <class Real, class Side>
void strike_free(const StruckDiscs& discs, ContactTerms<double>& terms, DoubleBody& a, Side& side,
                 ImpactPaths<Real>& paths, Blow& blow) {
    terms.mass = 1 / inverse_mass(a, side);
    terms.tangent_mass = tangent_mass<kEveryEffect>(a, side, terms.mass);
    const DoubleBody before_a = a;
    const Side before_side = side;
    const auto before = velocities(a, side, terms);
    solve_contact<kEveryEffect>(a, side, terms, blow.impulses, [](double wanted) { return wanted; });
    const auto change = [&](std::int32_t row, const DoubleBody& now, const DoubleBody& old) {
        blow.gravity_work += paths.change(
            row,
            {now.record[0] - old.record[0], now.record[1] - old.record[1], now.record[2] - old.record[2]},
            discs.time);
    };
    change(discs.a, a, before_a);
    if constexpr (Side::kMoves)
        if (discs.b != kNothing) change(discs.b, side, before_side);
    const auto after = velocities(a, side, terms);
    blow.by_normal = impact_work(blow.impulses.normal, before[0], after[0]);
    blow.by_friction = impact_work(blow.impulses.tangent, before[1], after[1]) +
                       impact_work(blow.impulses.rolling, before[2], after[2]);
}

/// Carries out the impact of discs of which joints hold one at least.
/// @param restitution  of the impact
/// @param surface  m/s: velocities of what nothing moves along the three directions; zeros if b is a disc
/// @param struck  out: rows whose velocities changed
/// @return whether they come to each other along what joints allow; if not, nothing has happened
template <class Real>
bool strike_held(HeldImpacts<Real>& held, const StruckDiscs& discs, const ContactTerms<double>& terms,
                 double restitution, const std::array<double, 3>& surface, ImpactPaths<Real>& paths,
                 Blow& blow, std::vector<std::int32_t>& struck) {
    using Law = typename HeldImpacts<Real>::Law;
    const Vec2 n{terms.nx, terms.ny}, t{-terms.ny, terms.nx};
    const std::array<typename HeldImpacts<Real>::Direction, 3> directions{
        {{Law::normal, n, 0, 0, surface[0]},
         {Law::friction, t, -1, -1, surface[1]},
         {Law::rolling, {}, -terms.of_a, 1 - terms.of_a, surface[2]}}};
    const std::size_t called_for = terms.rolling > 0 ? 3 : terms.friction > 0 ? 2 : 1;
    const auto record_of = [&](std::int32_t row) { return paths.record_of(row, paths.of(row), discs.time); };
    if (!held.solve({discs.a, discs.b}, std::span(directions).first(called_for),
                    {restitution, terms.friction, terms.rolling}, record_of))
        return false;
    const auto& j = held.impulses();
    blow.impulses = {j[0], j[1], j[2]};
    blow.by_normal = held.work_of(Law::normal);
    blow.by_friction = held.work_of(Law::friction) + held.work_of(Law::rolling);
    struck.clear();
    blow.by_joints = held.carry_out([&](std::int32_t row, const std::array<double, 3>& by) {
        struck.push_back(row);
        blow.gravity_work += paths.change(row, by, discs.time);
    });
    return true;
}

}  // namespace carom

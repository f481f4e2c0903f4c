#pragma once

#include "kernels/contact_arguments.hpp"
#include "simd/forget_loads.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// A body of a contact, a lane a contact.
template <class Lanes>
struct BodyLanes {
    using F = typename Lanes::Batch;
    typename Lanes::Batch4 record;

    template <unsigned kVariant>
    F inverse_mass() const {
        if constexpr ((kVariant & kFixedAngles) != 0) return simd::abs(record[3]);
        return record[3];
    }
    /// r²/I: what an impulse at the rim changes the rim speed by.
    template <unsigned kVariant>
    F inverse_inertia() const {
        if constexpr ((kVariant & kFixedAngles) != 0) {
            const F turning = simd::max(record[3], F(0));
            return turning + turning;
        }
        return record[3] + record[3];
    }
    /// Takes an impulse `normal` along n and `tangent` along t at the rim; the rim arm has the sign of both
    /// bodies' (docs/conventions.md): j along the tangent on b slows both rims.
    template <unsigned kVariant>
    void apply_impulse(F normal, F tangent, F nx, F ny, F sign) {
        const F w = inverse_mass<kVariant>() * sign;
        if constexpr ((kVariant & kRough) != 0) {
            record[0] += w * (normal * nx - tangent * ny);
            record[1] += w * (normal * ny + tangent * nx);
            record[2] -= inverse_inertia<kVariant>() * tangent;
        } else {
            record[0] += w * (normal * nx);
            record[1] += w * (normal * ny);
        }
    }
};

/// An impulse of a batch of contacts after this sweep, and what the sweep added to it.
template <class F>
struct ImpulseUpdate {
    F impulse, added;
};

// The contact laws. For discs the normal one does not couple with the others: a normal impulse changes
// neither the tangential velocity nor a spin.

/// Signorini: the relative normal velocity is at least `floor`, the impulse pushes. Over-relaxed (Young 1950)
/// it goes farther than the contact alone would want, since the next one will push back; less so where it
/// hardly changes, because nothing follows on the first sweep there.
template <bool kOverRelaxed, class Lanes, class Real>
ImpulseUpdate<typename Lanes::Batch> solve_normal(const SolveContacts<Real>& k, std::size_t c,
                                                  typename Lanes::Batch mass, typename Lanes::Batch velocity,
                                                  typename Lanes::Batch floor) {
    using F = typename Lanes::Batch;
    const F before = Lanes::load(k.contacts.normal_impulse + c);
    F wanted = mass * (floor - velocity);
    if constexpr (kOverRelaxed)
        wanted *= simd::select(simd::abs(wanted) > mass * F(k.calm), F(k.over_relaxation),
                               F(k.calm_over_relaxation));
    const F impulse = simd::max(before + wanted, F(0));
    Lanes::store(k.contacts.normal_impulse + c, impulse);
    return {impulse, impulse - before};
}

/// Coulomb, of sliding and of rolling alike: the impulse stops the motion, within `limit`. Returns what is
/// added.
template <class Lanes, class Real>
typename Lanes::Batch solve_limited(Real* impulses, typename Lanes::Batch mass,
                                    typename Lanes::Batch velocity, typename Lanes::Batch limit) {
    using F = typename Lanes::Batch;
    const F before = Lanes::load(impulses);
    const F held = simd::max(simd::min(before - mass * velocity, limit), -limit);
    Lanes::store(impulses, held);
    return held - before;
}

/// The tangential impulse that is added, for a normal impulse after this sweep.
template <unsigned kVariant, class Lanes, class Real>
typename Lanes::Batch solve_friction(const SolveContacts<Real>& k, std::size_t c,
                                     typename Lanes::Batch normal, typename Lanes::Batch mass,
                                     typename Lanes::Batch velocity) {
    using F = typename Lanes::Batch;
    if constexpr ((kVariant & kRough) == 0) return F(0);
    const F friction = k.contacts.friction ? Lanes::load(k.contacts.friction + c) : F(k.uniform_friction);
    return solve_limited<Lanes>(k.contacts.friction_impulse + c, mass, velocity, friction * normal);
}

/// The weight of body a's rim speed in the velocity at which two bodies roll on each other.
template <class Lanes, class Real>
typename Lanes::Batch share_of(const SolveContacts<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    return k.contacts.rolling_share ? Lanes::load(k.contacts.rolling_share + c) : F(Real(0.5));
}

/// The rolling impulse that is added. `inverse_mass` is zero if neither body turns.
template <class Lanes, class Real>
typename Lanes::Batch solve_rolling(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch normal,
                                    typename Lanes::Batch inverse_mass, typename Lanes::Batch velocity) {
    using F = typename Lanes::Batch;
    const F rolling = k.contacts.rolling ? Lanes::load(k.contacts.rolling + c) : F(k.uniform_rolling);
    const F mass = simd::select(inverse_mass > F(0), F(1) / inverse_mass, F(0));
    return solve_limited<Lanes>(k.contacts.rolling_impulse + c, mass, velocity, rolling * normal);
}

/// The first sweep over contacts also takes overlaps away, by displacement alone, and notes the floor: bodies
/// that are still apart may approach until they touch. `separation`: now. Returns the push [m] times the
/// effective mass, zero where there is no overlap.
template <class Lanes, class Real>
typename Lanes::Batch begin_contact(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch mass,
                                    typename Lanes::Batch separation, typename Lanes::Batch& floor) {
    using F = typename Lanes::Batch;
    floor = simd::min(-separation * F(k.inverse_h), F(0));
    Lanes::store(k.contacts.floor + c, floor);
    const F depth = simd::max(-separation, F(0));
    // The cap on the push grows with the load: what lies deep in a pile may recover as fast as its load
    // moves.
    const F load = Lanes::load(k.contacts.normal_impulse + c);
    return simd::min(mass * (F(k.recovery) * depth), mass * F(k.push) + F(k.h) * load);
}

/// For restitution: a contact that pushed in some substep has had an impact. At the start of a substep, the
/// impulses are what the one before came to.
template <class Lanes, class Real>
void note_largest_impulse(const SolveContacts<Real>& k, std::size_t c) {
    if (!k.contacts.largest_impulse) return;
    Lanes::store(k.contacts.largest_impulse + c, simd::max(Lanes::load(k.contacts.largest_impulse + c),
                                                           Lanes::load(k.contacts.normal_impulse + c)));
}

/// Marks the block of a batch in which a contact has changed too much to be left after one sweep.
template <class Lanes, class Real>
void note_second_sweep(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch mass,
                       typename Lanes::Batch normal_added, typename Lanes::Batch tangent_added) {
    using F = typename Lanes::Batch;
    const F added = simd::max(simd::abs(normal_added), simd::abs(tangent_added));
    if (simd::any(added > mass * F(k.calm))) k.needs_second_sweep[c / kContactBlock] = 1;
}

/// Pairs of bodies that both move. kFirst: the first sweep of a substep.
template <unsigned kVariant, bool kFirst, class Real, class Isa>
void solve_pairs(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const std::int32_t *row_a = k.contacts.a + c, *row_b = k.contacts.b + c;
        BodyLanes<Lanes> a{Lanes::load_rows4(k.velocity, row_a)}, b{Lanes::load_rows4(k.velocity, row_b)};
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const F mass = Lanes::load(k.contacts.mass + c);
        const F dvx = b.record[0] - a.record[0], dvy = b.record[1] - a.record[1];

        F floor(0);
        if constexpr (kFirst) {
            note_largest_impulse<Lanes>(k, c);
            simd::forget_loads();
            auto moved_a = Lanes::load_rows2(k.displacement, row_a);
            auto moved_b = Lanes::load_rows2(k.displacement, row_b);
            const F now = Lanes::load(k.contacts.separation + c) + (moved_b[0] - moved_a[0]) * nx +
                          (moved_b[1] - moved_a[1]) * ny;
            const F push = begin_contact<Lanes>(k, c, mass, now, floor);
            if (simd::any(push > F(0))) {
                const F push_a = push * a.template inverse_mass<kVariant>();
                const F push_b = push * b.template inverse_mass<kVariant>();
                moved_a[0] -= push_a * nx, moved_a[1] -= push_a * ny;
                moved_b[0] += push_b * nx, moved_b[1] += push_b * ny;
                Lanes::store_rows2(k.displacement, row_a, moved_a);
                Lanes::store_rows2(k.displacement, row_b, moved_b);
            }
        } else {
            floor = Lanes::load(k.contacts.floor + c);
        }

        F tangent_velocity(0), tangent_mass(0);
        if constexpr ((kVariant & kRough) != 0) {
            tangent_velocity = dvy * nx - dvx * ny - a.record[2] - b.record[2];
            if constexpr ((kVariant & kFixedAngles) != 0) {
                // A padding lane has no mass at all: its tangential mass must not be infinite.
                const F stiffness =
                    a.template inverse_mass<kVariant>() + b.template inverse_mass<kVariant>() +
                    a.template inverse_inertia<kVariant>() + b.template inverse_inertia<kVariant>();
                tangent_mass = simd::select(mass > F(0), F(1) / stiffness, F(0));
            } else {
                tangent_mass =
                    mass * F(Real(1) / Real(3));  // 1/ma + 1/mb + ra²/Ia + rb²/Ib = 3 (1/ma + 1/mb)
            }
        }
        const auto normal = solve_normal<kFirst, Lanes>(k, c, mass, dvx * nx + dvy * ny, floor);
        if constexpr ((kVariant & kRolling) != 0) {
            const F of_a = share_of<Lanes>(k, c), of_b = F(1) - of_a;
            const F inverse_a = of_a * a.template inverse_inertia<kVariant>();
            const F inverse_b = of_b * b.template inverse_inertia<kVariant>();
            const F roll = solve_rolling<Lanes>(k, c, normal.impulse, of_a * inverse_a + of_b * inverse_b,
                                                of_b * b.record[2] - of_a * a.record[2]);
            a.record[2] -= inverse_a * roll, b.record[2] += inverse_b * roll;
            tangent_velocity += (inverse_a - inverse_b) * roll;
        }
        const F tangent =
            solve_friction<kVariant, Lanes>(k, c, normal.impulse, tangent_mass, tangent_velocity);
        a.template apply_impulse<kVariant>(normal.added, tangent, nx, ny, F(-1));
        b.template apply_impulse<kVariant>(normal.added, tangent, nx, ny, F(1));
        Lanes::store_rows4(k.velocity, row_a, a.record);
        Lanes::store_rows4(k.velocity, row_b, b.record);
        if constexpr (kFirst) note_second_sweep<Lanes>(k, c, mass, normal.added, tangent);
    }
}

/// Bodies against what nothing moves: walls, static and kinematic bodies. Their surface moves at a steady
/// velocity through the step.
template <unsigned kVariant, bool kFirst, class Real, class Isa>
void solve_supports(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const std::int32_t* row = k.contacts.a + c;
        BodyLanes<Lanes> body{Lanes::load_rows4(k.velocity, row)};
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const F mass = Lanes::load(k.contacts.mass + c);
        const F surface = Lanes::load(k.contacts.surface_normal + c);

        F floor(0);
        if constexpr (kFirst) {
            note_largest_impulse<Lanes>(k, c);
            auto moved = Lanes::load_rows2(k.displacement, row);
            const F now = Lanes::load(k.contacts.separation + c) + surface * F(k.elapsed) -
                          (moved[0] * nx + moved[1] * ny);
            const F push = begin_contact<Lanes>(k, c, mass, now, floor);
            if (simd::any(push > F(0))) {
                const F push_body = push * body.template inverse_mass<kVariant>();
                moved[0] -= push_body * nx, moved[1] -= push_body * ny;
                Lanes::store_rows2(k.displacement, row, moved);
            }
        } else {
            floor = Lanes::load(k.contacts.floor + c);
        }

        F tangent_velocity(0), tangent_mass(0);
        if constexpr ((kVariant & kRough) != 0) {
            tangent_velocity = Lanes::load(k.contacts.surface_tangent + c) -
                               (body.record[1] * nx - body.record[0] * ny) - body.record[2];
            if constexpr ((kVariant & kFixedAngles) != 0) {
                const F stiffness =
                    body.template inverse_mass<kVariant>() + body.template inverse_inertia<kVariant>();
                tangent_mass = simd::select(mass > F(0), F(1) / stiffness, F(0));
            } else {
                tangent_mass = mass * F(Real(1) / Real(3));
            }
        }
        const F normal_velocity = surface - (body.record[0] * nx + body.record[1] * ny);
        const auto normal = solve_normal<false, Lanes>(k, c, mass, normal_velocity, floor);
        if constexpr ((kVariant & kRolling) != 0) {
            const F share = share_of<Lanes>(k, c);
            const F inverse = share * body.template inverse_inertia<kVariant>();
            const F roll =
                solve_rolling<Lanes>(k, c, normal.impulse, share * inverse,
                                     Lanes::load(k.contacts.surface_rolling + c) - share * body.record[2]);
            body.record[2] -= inverse * roll;
            tangent_velocity += inverse * roll;
        }
        const F tangent =
            solve_friction<kVariant, Lanes>(k, c, normal.impulse, tangent_mass, tangent_velocity);
        body.template apply_impulse<kVariant>(normal.added, tangent, nx, ny, F(-1));
        Lanes::store_rows4(k.velocity, row, body.record);
    }
}

/// Gives the bodies of a batch of pairs a share of the impulses that their contacts have.
template <unsigned kVariant, class Lanes, class Real>
void give_impulses_to_pairs(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch share) {
    using F = typename Lanes::Batch;
    const std::int32_t *row_a = k.contacts.a + c, *row_b = k.contacts.b + c;
    BodyLanes<Lanes> a{Lanes::load_rows4(k.velocity, row_a)}, b{Lanes::load_rows4(k.velocity, row_b)};
    const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
    const F normal = share * Lanes::load(k.contacts.normal_impulse + c);
    F tangent(0);
    if constexpr ((kVariant & kRough) != 0) tangent = share * Lanes::load(k.contacts.friction_impulse + c);
    a.template apply_impulse<kVariant>(normal, tangent, nx, ny, F(-1));
    b.template apply_impulse<kVariant>(normal, tangent, nx, ny, F(1));
    if constexpr ((kVariant & kRolling) != 0) {
        const F roll = share * Lanes::load(k.contacts.rolling_impulse + c), of_a = share_of<Lanes>(k, c);
        a.record[2] -= of_a * a.template inverse_inertia<kVariant>() * roll;
        b.record[2] += (F(1) - of_a) * b.template inverse_inertia<kVariant>() * roll;
    }
    Lanes::store_rows4(k.velocity, row_a, a.record);
    Lanes::store_rows4(k.velocity, row_b, b.record);
}

/// The same for supports.
template <unsigned kVariant, class Lanes, class Real>
void give_impulses_to_supported(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch share) {
    using F = typename Lanes::Batch;
    BodyLanes<Lanes> body{Lanes::load_rows4(k.velocity, k.contacts.a + c)};
    F tangent(0);
    if constexpr ((kVariant & kRough) != 0) tangent = share * Lanes::load(k.contacts.friction_impulse + c);
    body.template apply_impulse<kVariant>(share * Lanes::load(k.contacts.normal_impulse + c), tangent,
                                          Lanes::load(k.contacts.normal_x + c),
                                          Lanes::load(k.contacts.normal_y + c), F(-1));
    if constexpr ((kVariant & kRolling) != 0)
        body.record[2] -= share_of<Lanes>(k, c) * body.template inverse_inertia<kVariant>() *
                          (share * Lanes::load(k.contacts.rolling_impulse + c));
    Lanes::store_rows4(k.velocity, k.contacts.a + c, body.record);
}

/// Gives the bodies the impulses that their contacts had at the end of the step before.
template <unsigned kVariant, class Real, class Isa>
void warm_start_pairs(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size)
        give_impulses_to_pairs<kVariant, Lanes>(k, c, typename Lanes::Batch(1));
}

template <unsigned kVariant, class Real, class Isa>
void warm_start_supports(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    for (std::size_t c = first; c < last; c += Lanes::size)
        give_impulses_to_supported<kVariant, Lanes>(k, c, typename Lanes::Batch(1));
}

}  // namespace
}  // namespace carom

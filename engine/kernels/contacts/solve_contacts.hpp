#pragma once

#include "effects/contact_law.hpp"
#include "kernels/contacts/contact_arguments.hpp"
#include "simd/forget_loads.hpp"
#include "simd/lanes.hpp"

namespace carom {
namespace {

/// The other side of a batch of contacts: body b if it moves, else the velocity of a surface.
template <unsigned kVariant, bool kOtherMoves, class Lanes, class Real>
[[gnu::always_inline]] inline auto load_other_side(const SolveContacts<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    if constexpr (kOtherMoves) {
        return MovingSide<kVariant, Lanes>{Lanes::load_rows4(k.velocity, k.contacts.b + c)};
    } else {
        SteadySide<Lanes> surface{Lanes::load(k.contacts.surface_normal + c), F(0), F(0)};
        if constexpr ((kVariant & kRough) != 0) surface.tangent = Lanes::load(k.contacts.surface_tangent + c);
        if constexpr ((kVariant & kRolling) != 0)
            surface.rolling = Lanes::load(k.contacts.surface_rolling + c);
        return surface;
    }
}

/// Both sides' velocities back into their records.
template <class Lanes, class Real, class A, class B>
[[gnu::always_inline]] inline void store_sides(const SolveContacts<Real>& k, std::size_t c, const A& a,
                                               const B& b) {
    Lanes::store_rows4(k.velocity, k.contacts.a + c, a.record);
    if constexpr (B::kMoves) Lanes::store_rows4(k.velocity, k.contacts.b + c, b.record);
}

/// The weight of body a's rim speed in the rolling velocity.
template <unsigned kVariant, class Lanes, class Real>
typename Lanes::Batch share_of(const SolveContacts<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    if constexpr ((kVariant & kRolling) == 0) return F(0);
    return k.contacts.rolling_share ? Lanes::load(k.contacts.rolling_share + c) : F(Real(0.5));
}

template <unsigned kVariant, class Lanes, class Real>
[[gnu::always_inline]] inline ContactImpulses<typename Lanes::Batch> load_impulses(
    const SolveContacts<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    ContactImpulses<F> impulses{Lanes::load(k.contacts.normal_impulse + c), F(0), F(0)};
    if constexpr ((kVariant & kRough) != 0) impulses.tangent = Lanes::load(k.contacts.friction_impulse + c);
    if constexpr ((kVariant & kRolling) != 0) impulses.rolling = Lanes::load(k.contacts.rolling_impulse + c);
    return impulses;
}

template <unsigned kVariant, class Lanes, class Real>
[[gnu::always_inline]] inline void store_impulses(const SolveContacts<Real>& k, std::size_t c,
                                                  const ContactImpulses<typename Lanes::Batch>& impulses) {
    Lanes::store(k.contacts.normal_impulse + c, impulses.normal);
    if constexpr ((kVariant & kRough) != 0) Lanes::store(k.contacts.friction_impulse + c, impulses.tangent);
    if constexpr ((kVariant & kRolling) != 0) Lanes::store(k.contacts.rolling_impulse + c, impulses.rolling);
}

/// The first sweep notes the floor: bodies that are still apart may approach until they touch.
/// @param separation  m, now
/// @return how deep they are in each other [m]; without friction beyond the slop
template <unsigned kVariant, class Lanes, class Real>
typename Lanes::Batch begin_contact(const SolveContacts<Real>& k, std::size_t c,
                                    typename Lanes::Batch separation, typename Lanes::Batch& floor) {
    using F = typename Lanes::Batch;
    floor = simd::min(-separation * F(k.inverse_h), F(0));
    Lanes::store(k.contacts.floor + c, floor);
    const F depth = simd::max(-separation, F(0));
    if constexpr ((kVariant & kRough) != 0) return depth;
    F slop = F(k.slop);
    if (k.contacts.smaller) slop *= Lanes::load(k.contacts.smaller + c);
    return simd::max(depth - slop, F(0));
}

/// How far the first sweep pushes bodies apart that are in each other, by displacement alone [m], times the
/// effective mass.
template <class Lanes, class Real>
typename Lanes::Batch push_of(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch mass,
                              typename Lanes::Batch depth) {
    using F = typename Lanes::Batch;
    // The cap on the push grows with the load: what lies deep in a pile may recover as fast as its load
    // moves.
    const F load = Lanes::load(k.contacts.normal_impulse + c);
    F largest = F(k.push);
    if (k.contacts.smaller) largest *= Lanes::load(k.contacts.smaller + c);
    return simd::min(mass * (F(k.recovery) * depth), mass * largest + F(k.h) * load);
}

/// Marks the block of a batch in which a contact has changed too much to be left after one sweep.
template <class Lanes, class Real>
void note_second_sweep(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch mass,
                       typename Lanes::Batch normal_added, typename Lanes::Batch tangent_added) {
    using F = typename Lanes::Batch;
    const F added = simd::max(simd::abs(normal_added), simd::abs(tangent_added));
    if (simd::any(added > mass * F(k.calm))) k.needs_second_sweep[c / kContactBlock] = 1;
}

/// Takes away a share of the overlaps of a batch, by displacing bodies. @return the floors [m/s].
template <unsigned kVariant, class Lanes, class Real, class A, class B>
[[gnu::always_inline]] inline typename Lanes::Batch part_surfaces(const SolveContacts<Real>& k, std::size_t c,
                                                                  const A& a, const B& b,
                                                                  typename Lanes::Batch nx,
                                                                  typename Lanes::Batch ny,
                                                                  typename Lanes::Batch mass) {
    using F = typename Lanes::Batch;
    F floor(0);
    if constexpr (B::kMoves) {
        simd::forget_loads();
        auto moved_a = Lanes::load_rows2(k.displacement, k.contacts.a + c);
        auto moved_b = Lanes::load_rows2(k.displacement, k.contacts.b + c);
        const F now = Lanes::load(k.contacts.separation + c) + (moved_b[0] - moved_a[0]) * nx +
                      (moved_b[1] - moved_a[1]) * ny;
        const F depth = begin_contact<kVariant, Lanes>(k, c, now, floor);
        if (!simd::any(depth > F(0))) return floor;
        const F push = push_of<Lanes>(k, c, mass, depth);
        const F push_a = push * a.inverse_mass(), push_b = push * b.inverse_mass();
        moved_a[0] -= push_a * nx, moved_a[1] -= push_a * ny;
        moved_b[0] += push_b * nx, moved_b[1] += push_b * ny;
        Lanes::store_rows2(k.displacement, k.contacts.a + c, moved_a);
        Lanes::store_rows2(k.displacement, k.contacts.b + c, moved_b);
    } else {
        auto moved = Lanes::load_rows2(k.displacement, k.contacts.a + c);
        const F now = Lanes::load(k.contacts.separation + c) + b.normal * F(k.elapsed) -
                      (moved[0] * nx + moved[1] * ny);
        const F depth = begin_contact<kVariant, Lanes>(k, c, now, floor);
        if (!simd::any(depth > F(0))) return floor;
        const F push = push_of<Lanes>(k, c, mass, depth);
        const F push_a = push * a.inverse_mass();
        moved[0] -= push_a * nx, moved[1] -= push_a * ny;
        Lanes::store_rows2(k.displacement, k.contacts.a + c, moved);
    }
    return floor;
}

/// Calls solve.operator()<Lanes>(c) for batches of contacts one behind the other; the last takes short lanes
/// where they hold it. (Each contact's bits are the same in either.)
template <class Real, class Isa, class Solve>
[[gnu::always_inline]] inline void for_each_batch(std::size_t first, std::size_t last, const Solve& solve) {
    using Lanes = simd::Lanes<Real, Isa>;
    using ShortLanes = simd::ShortLanes<Real, Isa>;
    constexpr bool kAreShorter = ShortLanes::size < Lanes::size;
    std::size_t c = first;
    for (; c + (kAreShorter ? ShortLanes::size : 0) < last; c += Lanes::size)
        solve.template operator()<Lanes>(c);
    if constexpr (kAreShorter)
        if (c < last) solve.template operator()<ShortLanes>(c);
}

/// Contacts of pairs that both move, or of bodies with what nothing moves: walls, static and kinematic
/// bodies, whose surface moves at a steady velocity through the step. kFirst: the first sweep of a substep.
template <unsigned kVariant, bool kFirst, bool kOtherMoves, class Real, class Isa>
void solve_contacts(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    for_each_batch<Real, Isa>(
        first, last, [&k]<class Lanes>(std::size_t c) __attribute__((always_inline)) {
            using F = typename Lanes::Batch;
            MovingSide<kVariant, Lanes> a{Lanes::load_rows4(k.velocity, k.contacts.a + c)};
            auto b = load_other_side<kVariant, kOtherMoves, Lanes>(k, c);
            ContactTerms<F> terms{};
            terms.nx = Lanes::load(k.contacts.normal_x + c), terms.ny = Lanes::load(k.contacts.normal_y + c);
            terms.mass = Lanes::load(k.contacts.mass + c);
            if constexpr (kFirst)
                terms.floor = part_surfaces<kVariant, Lanes>(k, c, a, b, terms.nx, terms.ny, terms.mass);
            else
                terms.floor = Lanes::load(k.contacts.floor + c);
            terms.tangent_mass = tangent_mass<kVariant>(a, b, terms.mass);
            if constexpr ((kVariant & kRough) != 0)
                terms.friction =
                    k.contacts.friction ? Lanes::load(k.contacts.friction + c) : F(k.uniform_friction);
            if constexpr ((kVariant & kRolling) != 0)
                terms.rolling =
                    k.contacts.rolling ? Lanes::load(k.contacts.rolling + c) : F(k.uniform_rolling);
            terms.of_a = share_of<kVariant, Lanes>(k, c);

            ContactImpulses<F> impulses = load_impulses<kVariant, Lanes>(k, c);
            // The first sweep over pairs goes less far where it hardly changes: nothing follows on it there.
            const auto relax = [&](F wanted) {
                if constexpr (!kOtherMoves) return wanted;
                if constexpr (!kFirst) return wanted * F(k.next_over_relaxation);
                return wanted * simd::select(simd::abs(wanted) > terms.mass * F(k.calm), F(k.over_relaxation),
                                             F(k.calm_over_relaxation));
            };
            const ContactImpulses<F> added = solve_contact<kVariant>(a, b, terms, impulses, relax);
            store_impulses<kVariant, Lanes>(k, c, impulses);
            store_sides<Lanes>(k, c, a, b);
            if constexpr (kFirst && kOtherMoves)
                note_second_sweep<Lanes>(k, c, terms.mass, added.normal, added.tangent);
        });
}

/// Gives the bodies of a batch a share of the impulses that their contacts have.
template <unsigned kVariant, bool kOtherMoves, class Lanes, class Real>
[[gnu::always_inline]] inline void give_impulses(const SolveContacts<Real>& k, std::size_t c,
                                                 typename Lanes::Batch share) {
    using F = typename Lanes::Batch;
    MovingSide<kVariant, Lanes> a{Lanes::load_rows4(k.velocity, k.contacts.a + c)};
    auto b = load_other_side<kVariant, kOtherMoves, Lanes>(k, c);
    ContactImpulses<F> impulses = load_impulses<kVariant, Lanes>(k, c);
    impulses.normal = share * impulses.normal;
    if constexpr ((kVariant & kRough) != 0) impulses.tangent = share * impulses.tangent;
    if constexpr ((kVariant & kRolling) != 0) impulses.rolling = share * impulses.rolling;
    apply_impulses<kVariant>(a, b, Lanes::load(k.contacts.normal_x + c), Lanes::load(k.contacts.normal_y + c),
                             share_of<kVariant, Lanes>(k, c), impulses);
    store_sides<Lanes>(k, c, a, b);
}

/// Gives the bodies the impulses that their contacts had at the end of the step before.
template <unsigned kVariant, bool kOtherMoves, class Real, class Isa>
void warm_start(const SolveContacts<Real>& arguments, std::size_t first, std::size_t last) {
    const SolveContacts<Real> k = arguments;  // a copy: no store can change it
    for_each_batch<Real, Isa>(
        first, last, [&k]<class Lanes>(std::size_t c) __attribute__((always_inline)) {
            give_impulses<kVariant, kOtherMoves, Lanes>(k, c, typename Lanes::Batch(1));
        });
}

}  // namespace
}  // namespace carom

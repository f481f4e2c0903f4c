#pragma once

#include "kernels/contacts/solve_contacts.hpp"

// What engine/solvers/contact_sets/coarse_correction.hpp does to each contact. The loads of a body are two
// records of [4]:
//
//   load    the sum of its contacts' impulses (x, y) [N s]; the sum of half of what scaling each of them by
//           1 + s would change the kinetic energy by, for a small s, over s [J]; nothing
//   stress  what the sum of impulses changes by if s has a gradient (d/dx, d/dy) [1/m]: xx, xy, yx, yy
//           [N s m], the first letter of the impulse
//
// The s of a contact is the mean of those of its bodies. What friction does to rims is left out of `stress`:
// it is a fiftieth of the whole in a pile at rest, a fifth in one that falls.

namespace carom {
namespace {

template <unsigned kVariant, bool kOtherMoves, class Real, class Isa>
void sum_loads(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    const F half(Real(0.5));
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const std::int32_t *row_a = k.contacts.a + c, *row_b = kOtherMoves ? k.contacts.b + c : nullptr;
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const MovingSide<kVariant, Lanes> a{Lanes::load_rows4(k.velocity, row_a)};
        const auto b = load_other_side<kVariant, kOtherMoves, Lanes>(k, c);
        const auto impulses = load_impulses<kVariant, Lanes>(k, c);
        const F x = impulses.normal * nx - impulses.tangent * ny,
                y = impulses.normal * ny + impulses.tangent * nx;
        F rate = impulses.normal * (normal_velocity(a, b, nx, ny) - Lanes::load(k.contacts.floor + c));
        if constexpr ((kVariant & kRough) != 0) rate += impulses.tangent * tangent_velocity(a, b, nx, ny);
        if constexpr (kOtherMoves) rate = half * rate;

        auto load_a = Lanes::load_rows4(k.load, row_a);
        load_a[0] -= x, load_a[1] -= y, load_a[2] += rate;
        if constexpr (!kOtherMoves) {
            Lanes::store_rows4(k.load, row_a, load_a);
        } else {
            auto load_b = Lanes::load_rows4(k.load, row_b);
            load_b[0] += x, load_b[1] += y, load_b[2] += rate;
            Lanes::store_rows4(k.load, row_a, load_a);
            Lanes::store_rows4(k.load, row_b, load_b);

            // To either body the other one is at the distance d along the normal that points away from it,
            // and pushes against that normal: half of s' d goes with -d n.
            const F arm = half * (Lanes::load(k.reach + c) + Lanes::load(k.contacts.separation + c));
            const F arm_x = arm * nx, arm_y = arm * ny;
            const F xx = x * arm_x, xy = x * arm_y, yx = y * arm_x, yy = y * arm_y;
            for (const std::int32_t* row : {row_a, row_b}) {
                auto stress = Lanes::load_rows4(k.stress, row);
                stress[0] -= xx, stress[1] -= xy, stress[2] -= yx, stress[3] -= yy;
                Lanes::store_rows4(k.stress, row, stress);
            }
        }
    }
}

/// Multiplies the impulses of a batch of contacts.
template <unsigned kVariant, class Lanes, class Real>
void multiply_impulses(const SolveContacts<Real>& k, std::size_t c, typename Lanes::Batch factor) {
    const auto multiply = [&](Real* impulse) { Lanes::store(impulse, Lanes::load(impulse) * factor); };
    multiply(k.contacts.normal_impulse + c);
    if constexpr ((kVariant & kRough) != 0) multiply(k.contacts.friction_impulse + c);
    if constexpr ((kVariant & kRolling) != 0) multiply(k.contacts.rolling_impulse + c);
}

/// The s of a batch of contacts.
template <bool kOtherMoves, class Lanes, class Real>
typename Lanes::Batch scale_of(const SolveContacts<Real>& k, std::size_t c) {
    using F = typename Lanes::Batch;
    const F of_a = Lanes::gather_at(k.scale, k.contacts.a + c);
    if constexpr (!kOtherMoves) return of_a;
    return F(Real(0.5)) * (of_a + Lanes::gather_at(k.scale, k.contacts.b + c));
}

/// Gives the bodies the share s of their contacts' impulses once more, which become 1 + s times what they
/// were.
template <unsigned kVariant, bool kOtherMoves, class Real, class Isa>
void scale_loads(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const F scale = scale_of<kOtherMoves, Lanes>(k, c);
        give_impulses<kVariant, kOtherMoves, Lanes>(k, c, scale);
        multiply_impulses<kVariant, Lanes>(k, c, F(1) + scale);
    }
}

/// Leaves the contacts `kept` of what scaling added.
template <unsigned kVariant, bool kOtherMoves, class Real, class Isa>
void retain_correction(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const F scale = scale_of<kOtherMoves, Lanes>(k, c);
        multiply_impulses<kVariant, Lanes>(k, c, (F(1) + F(k.kept) * scale) / (F(1) + scale));
    }
}

}  // namespace
}  // namespace carom

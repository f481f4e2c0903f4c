#pragma once

#include "kernels/solve_contacts.hpp"

// What engine/solvers/shared/coarse_correction.hpp does to each contact. The loads of a body are two records
// of [4]:
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

/// Normal and tangential impulse of a batch of contacts, and their sum as a vector.
template <unsigned kVariant, class Lanes>
struct ImpulseLanes {
    using F = typename Lanes::Batch;
    F normal, tangent, x, y;

    template <class Real>
    ImpulseLanes(const SolveContacts<Real>& k, std::size_t c, F nx, F ny)
        : normal(Lanes::load(k.contacts.normal_impulse + c)), tangent(F(0)) {
        if constexpr ((kVariant & kRough) != 0) tangent = Lanes::load(k.contacts.friction_impulse + c);
        x = normal * nx - tangent * ny, y = normal * ny + tangent * nx;
    }
};

template <unsigned kVariant, class Real, class Isa>
void sum_loads_pairs(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const std::int32_t *row_a = k.contacts.a + c, *row_b = k.contacts.b + c;
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const ImpulseLanes<kVariant, Lanes> impulse(k, c, nx, ny);
        const auto a = Lanes::load_rows4(k.velocity, row_a), b = Lanes::load_rows4(k.velocity, row_b);
        const F dvx = b[0] - a[0], dvy = b[1] - a[1];
        F rate = impulse.normal * (dvx * nx + dvy * ny - Lanes::load(k.contacts.floor + c));
        if constexpr ((kVariant & kRough) != 0) rate += impulse.tangent * (dvy * nx - dvx * ny - a[2] - b[2]);
        const F half(Real(0.5)), half_rate = half * rate;

        auto load_a = Lanes::load_rows4(k.load, row_a), load_b = Lanes::load_rows4(k.load, row_b);
        load_a[0] -= impulse.x, load_a[1] -= impulse.y, load_a[2] += half_rate;
        load_b[0] += impulse.x, load_b[1] += impulse.y, load_b[2] += half_rate;
        Lanes::store_rows4(k.load, row_a, load_a);
        Lanes::store_rows4(k.load, row_b, load_b);

        // To either body the other one is at the distance d along the normal that points away from it, and
        // pushes against that normal: half of s' d goes with -d n.
        const F arm = half * (Lanes::load(k.reach + c) + Lanes::load(k.contacts.separation + c));
        const F arm_x = arm * nx, arm_y = arm * ny;
        const F xx = impulse.x * arm_x, xy = impulse.x * arm_y, yx = impulse.y * arm_x,
                yy = impulse.y * arm_y;
        for (const std::int32_t* row : {row_a, row_b}) {
            auto stress = Lanes::load_rows4(k.stress, row);
            stress[0] -= xx, stress[1] -= xy, stress[2] -= yx, stress[3] -= yy;
            Lanes::store_rows4(k.stress, row, stress);
        }
    }
}

template <unsigned kVariant, class Real, class Isa>
void sum_loads_supports(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const std::int32_t* row = k.contacts.a + c;
        const F nx = Lanes::load(k.contacts.normal_x + c), ny = Lanes::load(k.contacts.normal_y + c);
        const ImpulseLanes<kVariant, Lanes> impulse(k, c, nx, ny);
        const auto body = Lanes::load_rows4(k.velocity, row);
        F rate = impulse.normal * (Lanes::load(k.contacts.surface_normal + c) -
                                   (body[0] * nx + body[1] * ny) - Lanes::load(k.contacts.floor + c));
        if constexpr ((kVariant & kRough) != 0)
            rate += impulse.tangent *
                    (Lanes::load(k.contacts.surface_tangent + c) - (body[1] * nx - body[0] * ny) - body[2]);
        auto load = Lanes::load_rows4(k.load, row);
        load[0] -= impulse.x, load[1] -= impulse.y, load[2] += rate;
        Lanes::store_rows4(k.load, row, load);
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

/// Gives the bodies the share s of their contacts' impulses once more, which become 1 + s times what they
/// were.
template <unsigned kVariant, class Real, class Isa>
void scale_loads_pairs(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const F share = F(Real(0.5)) * (Lanes::gather_at(k.scale, k.contacts.a + c) +
                                        Lanes::gather_at(k.scale, k.contacts.b + c));
        give_impulses_to_pairs<kVariant, Lanes>(k, c, share);
        multiply_impulses<kVariant, Lanes>(k, c, F(1) + share);
    }
}

template <unsigned kVariant, class Real, class Isa>
void scale_loads_supports(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        const F share = Lanes::gather_at(k.scale, k.contacts.a + c);
        give_impulses_to_supported<kVariant, Lanes>(k, c, share);
        multiply_impulses<kVariant, Lanes>(k, c, F(1) + share);
    }
}

/// Leaves the contacts `kept` of what scaling added.
template <unsigned kVariant, bool kArePairs, class Real, class Isa>
void retain_correction(const SolveContacts<Real>& k, std::size_t first, std::size_t last) {
    using Lanes = simd::Lanes<Real, Isa>;
    using F = typename Lanes::Batch;
    for (std::size_t c = first; c < last; c += Lanes::size) {
        F share = Lanes::gather_at(k.scale, k.contacts.a + c);
        if constexpr (kArePairs) share = F(Real(0.5)) * (share + Lanes::gather_at(k.scale, k.contacts.b + c));
        multiply_impulses<kVariant, Lanes>(k, c, (F(1) + F(k.kept) * share) / (F(1) + share));
    }
}

}  // namespace
}  // namespace carom
